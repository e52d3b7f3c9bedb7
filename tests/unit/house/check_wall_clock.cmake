# SPDX-License-Identifier: Apache-2.0
# Fails if code of the live path reads a clock that people or NTP can set. ROOT: the tree to check.
cmake_minimum_required(VERSION 3.25)
set(breaches "")
foreach(module IN ITEMS firmware hal host/capture/capture host/capture/live host/capture/open host/capture/sync host/operator/desk host/output
  host/pose host/room host/run extras/kinect2 extras/openni2 extras/libcamera extras/people/watch)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${module}/*.h ${ROOT}/${module}/*.cpp)
  foreach(file IN LISTS files)
    file(STRINGS ${ROOT}/${file} lines REGEX "system_clock|CLOCK_REALTIME|gettimeofday|std::time\\(")
    foreach(line IN LISTS lines)
      string(APPEND breaches "\n  ${file}: ${line}")
    endforeach()
  endforeach()
endforeach()
if(breaches)
  message(FATAL_ERROR "live code reads the wall clock, which may be set at any time:${breaches}")
endif()
