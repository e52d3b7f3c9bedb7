# SPDX-License-Identifier: Apache-2.0
# Fails when a room includes what it may not (ARCHITECTURE.md). ROOT: the tree to look at.
cmake_minimum_required(VERSION 3.25)

# room : the project folders it may include, beside itself
set(RULES
  "firmware/protocol:"
  "firmware/app:firmware/protocol|firmware/port/port.h"
  "firmware/port:firmware/app|firmware/protocol"
  "hal/base:"
  "hal/device:hal/base"
  "hal/linux:hal/base|hal/device|firmware/protocol"
  "hal/fake:hal/base|hal/device|firmware"
  "host/config:hal/base"
  "host/geometry:hal/base"
  "host/estimation:hal/base|host/geometry"
  "host/estimation_bench:hal/base|host/geometry|host/estimation"
  "host/sync:hal/base|hal/device|host/geometry|host/estimation"
  "host/image_io:hal/base"
  "host/camera_io:hal/base|host/geometry|host/image_io"
  "host/calibration:hal/base|host/config|host/geometry|host/estimation|host/image_io|host/camera_io"
  "host/scene:hal/base|host/config|host/geometry|host/image_io"
  "host/take:hal/base|host/config|host/geometry|host/image_io"
  "host/stream:hal/base|host/geometry"
  "host/mocap:hal/base|host/config|host/camera_io|host/geometry|host/estimation|host/stream"
  "host/model:hal/base|host/config|host/geometry|host/image_io"
  "host/measure:hal/base"
  "host/rig:hal/base|hal/device|hal/linux|host/config|host/geometry|host/image_io|host/sync|host/take"
  "host/render:hal/base|host/geometry|shaders"
  "host/studio:hal/base|hal/device|host/geometry/pose.h"
  "host/app:hal|host|shaders"
  "host/tools:hal|host|firmware")
# header pattern : the only rooms that may include it
set(VENDORS
  "opencv2/:host/calibration|host/tracking|host/lights|tests"
  "embree:host/studio"
  "GLES|EGL/:host/render/gles|tests/gl"
  "linux/|libusb|gpiod|libserialport|arv\\.h:hal/linux|hal/fake"
  "yaml-cpp:host/camera_io"
  "toml\\+\\+|toml\\.hpp:host/config"
  "tiny_gltf:host/scene|tests"
  "gst/:host/take|host/stream")

set(breaches "")
foreach(rule IN LISTS RULES)
  string(FIND "${rule}" ":" colon)
  string(SUBSTRING "${rule}" 0 ${colon} room)
  math(EXPR after "${colon} + 1")
  string(SUBSTRING "${rule}" ${after} -1 allowed)
  string(REPLACE "|" ";" allowed "${allowed}")
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${room}/*.h ${ROOT}/${room}/*.cpp)
  foreach(file IN LISTS files)
    file(STRINGS ${ROOT}/${file} lines REGEX "^#include \"(hal|host|firmware|shaders|tests)/")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" header "${line}")
      set(fine FALSE)
      foreach(prefix IN LISTS room allowed)
        string(FIND "${header}" "${prefix}" at)
        if(at EQUAL 0)
          set(fine TRUE)
        endif()
      endforeach()
      if(NOT fine)
        list(APPEND breaches "${file} includes ${header}")
      endif()
    endforeach()
  endforeach()
endforeach()

file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/hal/*.h ${ROOT}/hal/*.cpp ${ROOT}/host/*.h ${ROOT}/host/*.cpp)
foreach(rule IN LISTS VENDORS)
  string(REGEX REPLACE "^(.*):([^:]*)$" "\\1" pattern "${rule}")
  string(REGEX REPLACE "^(.*):([^:]*)$" "\\2" homes "${rule}")
  foreach(file IN LISTS files)
    if(NOT file MATCHES "^(${homes})/")
      file(STRINGS ${ROOT}/${file} lines REGEX "^#include <(${pattern})")
      foreach(line IN LISTS lines)
        list(APPEND breaches "${file}: ${line}")
      endforeach()
    endif()
  endforeach()
endforeach()

if(breaches)
  list(JOIN breaches "\n  " text)
  message(FATAL_ERROR "a room includes what it may not:\n  ${text}")
endif()
