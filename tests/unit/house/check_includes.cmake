# SPDX-License-Identifier: Apache-2.0
# Fails when a module includes a header of a module or a package that its link list does not give it.
# The link lists of the modules' CMakeLists.txt are the rule; the compiler enforces it for project
# headers already (each module has its own tree of headers), this test says it in one line and covers
# packages, whose headers lie in /usr/include.
# ROOT: the tree to look at. MODULES: modules.txt of the build, "name|folder|links|private links" a line.
# LEFT_OUT: folders of the modules that this build leaves out; the command then has files that are not
# built, and is not looked at.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/modules.cmake)
read_modules(${MODULES})

# header of a package : what the link list must hold, as a regular expression
set(PACKAGES
  "opencv2/:opencv_"
  "embree:embree"
  "GLES|EGL/:libEGL|libGLES"
  "linux/|libusb|gpiod|libserialport|arv\\.h:PkgConfig::(LIBUSB|GPIOD|LIBSERIALPORT|ARAVIS)"
  "yaml-cpp:yaml-cpp"
  "toml\\+\\+|toml\\.hpp:tomlplusplus"
  "tiny_gltf:TinyGLTF"
  "meshoptimizer\\.h:meshoptimizer"
  "gst/:PkgConfig::GSTREAMER"
  "cairo:PkgConfig::CAIRO"
  "Bullet|LinearMath/:PkgConfig::BULLET"
  "ceres/|glog/:Ceres"
  "Eigen/:Eigen3|mixrig::"
  "nlohmann/:nlohmann_json"
  "CLI/:CLI11"
  "libyuv:libyuv"
  "zlib:ZLIB")
# One file of a module instead of all: the studio shares the type of a pose with what it judges.
set(ONLY "studio:host/math/geometry:host/math/geometry/pose.h")

set(breaches "")
foreach(module IN LISTS MIXRIG_MODULE_NAMES)
  set(folder ${${module}_folder})
  if(LEFT_OUT AND folder STREQUAL "host/tools")
    continue()
  endif()
  set(links ${${module}_links} ${${module}_private_links})
  reachable_modules(${module} seen)
  file(GLOB files RELATIVE ${ROOT} ${ROOT}/${folder}/*.h ${ROOT}/${folder}/*.cpp)
  file(GLOB inner RELATIVE ${ROOT} ${ROOT}/${folder}/*/*.h ${ROOT}/${folder}/*/*.cpp)
  foreach(file IN LISTS inner)
    folder_of(${file} owner)
    if(owner STREQUAL folder)
      list(APPEND files ${file})
    endif()
  endforeach()
  list(FILTER files EXCLUDE REGEX "^firmware/port/stm32f4/")  # a project of its own
  list(FILTER files EXCLUDE REGEX "^host/judge/bench/opencv_peers.cpp$")  # of MIXRIG_BENCH_PEERS alone
  foreach(file IN LISTS files)
    file(STRINGS ${ROOT}/${file} lines REGEX "^#include [\"<]")
    foreach(line IN LISTS lines)
      if(line MATCHES "^#include \"((hal|host|extras|studio|firmware|shaders|tests)/[^\"]+)\"")
        set(header ${CMAKE_MATCH_1})
        folder_of(${header} owner)
        if(NOT owner STREQUAL folder AND NOT owner IN_LIST seen)
          list(APPEND breaches "${file} includes ${header}")
        endif()
        foreach(rule IN LISTS ONLY)
          string(REPLACE ":" ";" rule ${rule})
          list(GET rule 0 who)
          list(GET rule 1 whose)
          list(GET rule 2 one)
          if(folder STREQUAL who AND owner STREQUAL whose AND NOT header STREQUAL one)
            list(APPEND breaches "${file} includes ${header}, but may include only ${one} of ${whose}")
          endif()
        endforeach()
        continue()
      endif()
      foreach(rule IN LISTS PACKAGES)
        string(REGEX REPLACE "^(.*[^:]):([^:].*)$" "\\1;\\2" rule "${rule}")
        list(GET rule 0 pattern)
        list(GET rule 1 needed)
        if(line MATCHES "^#include <(${pattern})" AND NOT "${links}" MATCHES "${needed}")
          list(APPEND breaches "${file}: ${line}: link list of ${folder} has no ${needed}")
        endif()
      endforeach()
    endforeach()
  endforeach()
endforeach()

if(breaches)
  list(JOIN breaches "\n  " text)
  message(FATAL_ERROR "a module includes what it does not link:\n  ${text}")
endif()
