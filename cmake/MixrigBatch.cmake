# SPDX-License-Identifier: Apache-2.0
# For builds from nothing (./check, ./demo): most files spend their time on the same headers and
# templates. These are precompiled, and the files of a module are compiled many at a time (a unity
# build), so that names in anonymous namespaces are unique in a module. Off by default: an edit in the
# tree is then compiled alone and with its own includes only, and ccache is of more use.
option(MIXRIG_BATCH "Precompiled headers, and several files of a module in one compilation" OFF)
if(NOT MIXRIG_BATCH OR MIXRIG_FUZZ)
  function(mixrig_precompile)
  endfunction()
  function(mixrig_compile_group out)
    set(${out} "" PARENT_SCOPE)
  endfunction()
  return()
endif()

set(CMAKE_UNITY_BUILD ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)  # of tests
# Largest number of files in one compilation; fewer where it would take over a minute or 2.5 GB.
set(MIXRIG_BATCH_FILES 32)
set(MIXRIG_BATCH_FILES_mixrig_estimation 8)
set(MIXRIG_BATCH_FILES_mixrig_reconstruction 11)
set(MIXRIG_BATCH_FILES_mixrig 21)
add_compile_options(-pthread)  # the same for all, or a header would not be taken
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fpch-preprocess)  # for ccache
  add_compile_options(--param=ggc-min-heapsize=786432)  # kB that the compiler uses before it collects
endif()
file(WRITE ${CMAKE_BINARY_DIR}/batch/empty.cpp "")

# Tests are compiled in 0.6 to 0.97 of the time with -O1 (0.8 together). Modules stay at -O3; of an inline
# function that both hold, a test program keeps its own copy.
set(MIXRIG_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)

# mixrig_pch(NAME HEADERS ... LINKS ...): a target that owns one precompiled header.
function(mixrig_pch name)
  cmake_parse_arguments(P "" "" "HEADERS;LINKS" ${ARGN})
  add_library(mixrig_pch_${name} OBJECT ${CMAKE_BINARY_DIR}/batch/empty.cpp)
  target_link_libraries(mixrig_pch_${name} PRIVATE mixrig_options fmt::fmt Eigen3::Eigen ${P_LINKS})
  target_precompile_headers(mixrig_pch_${name} PRIVATE
    <algorithm> <array> <atomic> <charconv> <chrono> <cmath> <cstdint> <cstdio> <cstring> <filesystem>
    <fstream> <functional> <limits> <map> <memory> <mutex> <numbers> <numeric> <optional> <random> <span>
    <sstream> <string> <string_view> <thread> <utility> <variant> <vector>
    <fmt/format.h> <Eigen/Dense> ${P_HEADERS})
endfunction()

find_package(fmt REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
mixrig_pch(module)
if(MIXRIG_TESTS)
  find_package(GTest REQUIRED)
  mixrig_pch(test HEADERS <gtest/gtest.h> LINKS GTest::gtest)
  target_compile_options(mixrig_pch_test PRIVATE ${MIXRIG_TEST_OPTIONS})
endif()

# mixrig_precompile(TARGET WHICH): WHICH is module or test.
function(mixrig_precompile target which)
  target_link_libraries(${target} PRIVATE fmt::fmt)  # its macro is part of the header
  target_precompile_headers(${target} REUSE_FROM mixrig_pch_${which})
  if(which STREQUAL "test")
    target_compile_options(${target} PRIVATE ${MIXRIG_TEST_OPTIONS})
    return()
  endif()
  set(most ${MIXRIG_BATCH_FILES})
  if(DEFINED MIXRIG_BATCH_FILES_${target})
    set(most ${MIXRIG_BATCH_FILES_${target}})
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE ${most})
endfunction()

# Folders whose modules are compiled as one target: small modules spend most of their time on the headers
# that all of them include. What a module may include is then not checked by the compiler, but by house.includes.
set(MIXRIG_COMPILE_GROUPS hal host/capture host/room host/output host/run extras/people extras/broadcast)
# Eigen's templates take longer in one unit than in two; hal/linux has the headers of many libraries.
set(MIXRIG_COMPILED_ALONE hal/linux hal/fake host/room/scan host/room/lamps)

# Group of the folder that is being read; empty if it has none.
function(mixrig_compile_group out)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  cmake_path(GET folder PARENT_PATH floor)
  set(group "")
  if(floor IN_LIST MIXRIG_COMPILE_GROUPS AND NOT folder IN_LIST MIXRIG_COMPILED_ALONE)
    string(MAKE_C_IDENTIFIER mixrig_group_${floor} group)
  endif()
  set(${out} ${group} PARENT_SCOPE)
endfunction()

# Helper of mixrig_module(): it reads MODULE_SOURCES, MODULE_LINKS and MODULE_PRIVATE_LINKS of its
# caller.
function(mixrig_add_to_group group name tree)
  if(NOT TARGET ${group})
    add_library(${group} STATIC)
    target_link_libraries(${group} PUBLIC mixrig_options)
    mixrig_precompile(${group} module)
  endif()
  list(TRANSFORM MODULE_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ REGEX "^[^/]")
  target_sources(${group} PRIVATE ${MODULE_SOURCES})
  target_include_directories(${group} PRIVATE ${tree})
  foreach(link IN LISTS MODULE_LINKS MODULE_PRIVATE_LINKS)
    get_property(own GLOBAL PROPERTY MIXRIG_GROUP_OF_${link})
    if(own STREQUAL group)
      continue()  # compiled with it
    elseif(link IN_LIST MODULE_LINKS)
      target_link_libraries(${group} PUBLIC ${link})
    else()
      target_link_libraries(${group} PRIVATE ${link})
    endif()
  endforeach()
  set_property(GLOBAL PROPERTY MIXRIG_GROUP_OF_mixrig::${name} ${group})
  add_library(mixrig_${name} INTERFACE)
  target_include_directories(mixrig_${name} INTERFACE ${tree})
  target_link_libraries(mixrig_${name} INTERFACE mixrig_options ${MODULE_LINKS} ${group})
endfunction()
