# SPDX-License-Identifier: Apache-2.0
# Language level, warnings and the switches of the build.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

option(MIXRIG_TESTS "Build the tests" ON)
# Extras (ARCHITECTURE.md, "Core and extras"): each is the folder of its name in extras/, or studio/.
set(MIXRIG_ALL_EXTRAS people map broadcast kinect2 openni2 libcamera studio)
set(MIXRIG_EXTRAS "${MIXRIG_ALL_EXTRAS}" CACHE STRING "Extras that are built, a list of ${MIXRIG_ALL_EXTRAS}")
foreach(extra IN LISTS MIXRIG_EXTRAS)
  if(NOT extra IN_LIST MIXRIG_ALL_EXTRAS)
    message(FATAL_ERROR "MIXRIG_EXTRAS: '${extra}' is none of ${MIXRIG_ALL_EXTRAS}")
  endif()
endforeach()
option(MIXRIG_CALIBRATE "Build the calibration from pictures, which needs OpenCV and Ceres" ON)
# A quarter less to compile before the first picture. Every `cmake --preset` turns it off again, with
# what is selected above unchanged in the cache.
option(MIXRIG_DEMO_ONLY "What ./demo runs: of the extras the studio, and no calibration" OFF)
if(MIXRIG_DEMO_ONLY)
  set(MIXRIG_EXTRAS studio)
  set(MIXRIG_CALIBRATE OFF)
endif()
option(MIXRIG_WERROR "Warnings are errors" OFF)
option(MIXRIG_ASSERTS "Assertions run, in optimised builds too" ON)
if(MIXRIG_ASSERTS)
  foreach(language C CXX)
    foreach(config RELEASE RELWITHDEBINFO)
      string(REPLACE "-DNDEBUG" "" CMAKE_${language}_FLAGS_${config} "${CMAKE_${language}_FLAGS_${config}}")
    endforeach()
  endforeach()
endif()
# Faults of memory end the program where they can be noticed, as in Debian's packages.
option(MIXRIG_HARDEN "Checks of buffers, stack and containers in optimised builds" OFF)
if(MIXRIG_HARDEN)
  add_compile_options(-fstack-protector-strong -fstack-clash-protection -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2 -D_GLIBCXX_ASSERTIONS)
  add_link_options(-Wl,-z,relro,-z,now)
endif()
option(MIXRIG_FUZZ "Build libFuzzer targets (clang only)" OFF)
set(MIXRIG_MARCH "native" CACHE STRING
    "-march of the host build; native is this machine's level (MixrigMarch.cmake), empty the compiler's default")
set(MIXRIG_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")

find_program(MIXRIG_CCACHE ccache)
if(MIXRIG_CCACHE)
  # Without this ccache leaves out every file that uses a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros ${MIXRIG_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${MIXRIG_CCACHE})
endif()

# Uses a faster linker if there is one.
find_program(MIXRIG_LD NAMES ld.mold ld.lld)
if(MIXRIG_LD AND NOT CMAKE_CROSSCOMPILING)
  string(REGEX REPLACE ".*/ld\\." "" linker ${MIXRIG_LD})
  add_link_options(-fuse-ld=${linker})
endif()

# Shared libraries that contain Eigen's functions too, for another processor, keep their own copies.
if(NOT CMAKE_CROSSCOMPILING)
  add_link_options(-Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/keep_eigen_inside.map)
endif()

add_library(mixrig_options INTERFACE)
target_compile_options(mixrig_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -fno-math-errno -fno-trapping-math
  # g++ 12 gives false warnings in its own AVX-512 headers and in std::string (GCC bug 105651);
  # which ones depends on the processor that the build is for. clang-tidy looks for the real ones.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-uninitialized>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
target_compile_definitions(mixrig_options INTERFACE MIXRIG_VERSION="${PROJECT_VERSION}")
if(MIXRIG_WERROR)
  target_compile_options(mixrig_options INTERFACE -Werror)
  # Warnings of the optimiser after inlining, which vary with processor and flags.
  foreach(ghost stringop-truncation free-nonheap-object nonnull dangling-pointer use-after-free)
    target_compile_options(mixrig_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-error=${ghost}>)
  endforeach()
endif()
include(MixrigMarch)
if(MIXRIG_SANITIZE)
  add_compile_options(-fsanitize=${MIXRIG_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${MIXRIG_SANITIZE})
endif()
if(MIXRIG_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)  # coverage, which steers the fuzzers
endif()
