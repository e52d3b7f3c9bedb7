# SPDX-License-Identifier: Apache-2.0
# Adds one -march for the whole tree: Eigen's alignment must be the same in every object.
# "native" becomes the highest level of the x86-64 psABI that this machine has. A compiler cache that
# several machines share then never hands out an object that was made for another processor (the
# words "-march=native" are the same on all of them), and what runs is one of the four builds that
# tests/levels holds to the same pictures. Elsewhere than x86-64 it is the compiler's default.
if(CMAKE_CROSSCOMPILING)
  return()
endif()

# Macros that gcc and clang define for each level, highest first.
set(MIXRIG_LEVELS x86-64-v4 x86-64-v3 x86-64-v2 x86-64)
set(MIXRIG_MACROS_OF_x86-64-v4 __AVX512F__ __AVX512BW__ __AVX512CD__ __AVX512DQ__ __AVX512VL__)
set(MIXRIG_MACROS_OF_x86-64-v3 __AVX2__ __BMI__ __BMI2__ __F16C__ __FMA__ __LZCNT__ __MOVBE__)
set(MIXRIG_MACROS_OF_x86-64-v2 __POPCNT__ __SSE3__ __SSE4_1__ __SSE4_2__ __SSSE3__)
set(MIXRIG_MACROS_OF_x86-64 __x86_64__)

# mixrig_level(MARCH OUT): the highest level whose instructions `-march=MARCH` allows; empty
# elsewhere than x86-64.
function(mixrig_level march out)
  set(flag "")
  if(march)
    set(flag -march=${march})
  endif()
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${flag} -dM -E -x c++ /dev/null
    OUTPUT_VARIABLE macros RESULT_VARIABLE failed ERROR_VARIABLE error)
  if(failed)
    message(FATAL_ERROR "MIXRIG_MARCH=${march}: ${CMAKE_CXX_COMPILER} does not take it: "
      "use native, x86-64-v3 or another value of -march\n${error}")
  endif()
  set(${out} "" PARENT_SCOPE)
  # Checks from the lowest level up: a level has everything that the levels below it have.
  set(levels ${MIXRIG_LEVELS})
  list(REVERSE levels)
  foreach(level IN LISTS levels)
    foreach(macro IN LISTS MIXRIG_MACROS_OF_${level})
      if(NOT macros MATCHES "#define ${macro} ")
        return()
      endif()
    endforeach()
    set(${out} ${level} PARENT_SCOPE)
  endforeach()
endfunction()

set(march "${MIXRIG_MARCH}")
if(march STREQUAL "native")
  mixrig_level(native march)
endif()
mixrig_level("${march}" level)
message(STATUS "mixrig is built for ${CMAKE_SYSTEM_PROCESSOR}, level '${level}', MIXRIG_MARCH ${MIXRIG_MARCH}")
if(march)
  add_compile_options(-march=${march})
endif()
