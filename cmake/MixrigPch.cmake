# SPDX-License-Identifier: Apache-2.0
# Precompiled headers, for builds from nothing (./check, ./demo): most files spend their time on
# the same headers. Off by default: an edit in the tree is then compiled with its own includes only,
# and ccache is of more use.
option(MIXRIG_PCH "Precompile the standard library, fmt, Eigen, JSON and GoogleTest" OFF)
if(NOT MIXRIG_PCH OR MIXRIG_FUZZ)
  function(mixrig_precompile)
  endfunction()
  function(mixrig_precompile_room)
  endfunction()
  return()
endif()

add_compile_options(-pthread)  # the same for all, or a header would not be taken
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fpch-preprocess)  # for ccache
endif()
set(MIXRIG_PCH_STD <algorithm> <array> <atomic> <charconv> <chrono> <cmath> <cstdint> <cstdio> <cstring>
    <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex> <numbers> <numeric> <optional>
    <random> <span> <sstream> <string> <string_view> <thread> <utility> <variant> <vector>)
file(WRITE ${CMAKE_BINARY_DIR}/pch/empty.cpp "")

# mixrig_pch(NAME HEADERS ... LINKS ...): a target that owns one precompiled header.
function(mixrig_pch name)
  cmake_parse_arguments(P "" "" "HEADERS;LINKS" ${ARGN})
  add_library(mixrig_pch_${name} OBJECT ${CMAKE_BINARY_DIR}/pch/empty.cpp)
  target_link_libraries(mixrig_pch_${name} PRIVATE mixrig_options ${P_LINKS})
  target_precompile_headers(mixrig_pch_${name} PRIVATE ${MIXRIG_PCH_STD} ${P_HEADERS})
endfunction()

find_package(fmt REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(nlohmann_json REQUIRED)
# Each kind holds what the one before it holds.
set(MIXRIG_PCH_KINDS std fmt eigen json)
mixrig_pch(std)
mixrig_pch(fmt HEADERS <fmt/format.h> LINKS fmt::fmt)
mixrig_pch(eigen HEADERS <fmt/format.h> <Eigen/Dense> LINKS fmt::fmt Eigen3::Eigen)
mixrig_pch(json HEADERS <fmt/format.h> <Eigen/Dense> <nlohmann/json.hpp>
  LINKS fmt::fmt Eigen3::Eigen nlohmann_json::nlohmann_json)
if(MIXRIG_TESTS)
  find_package(GTest REQUIRED)
  mixrig_pch(test HEADERS <fmt/format.h> <Eigen/Dense> <nlohmann/json.hpp> <gtest/gtest.h>
    LINKS fmt::fmt Eigen3::Eigen nlohmann_json::nlohmann_json GTest::gtest)
endif()

# mixrig_precompile(TARGET WHICH): WHICH is one of the kinds, or test.
function(mixrig_precompile target which)
  if(which STREQUAL "test")
    target_link_libraries(${target} PRIVATE fmt::fmt)  # its macro is part of the header
  endif()
  target_precompile_headers(${target} REUSE_FROM mixrig_pch_${which})
endfunction()

# mixrig_precompile_room(TARGET LINKS ...): the highest kind among what a room links, itself or
# through others.
function(mixrig_precompile_room target)
  set(highest 0)
  foreach(link IN LISTS ARGN)
    set(of_link "")
    if(link STREQUAL "fmt::fmt")
      set(of_link fmt)
    elseif(link STREQUAL "Eigen3::Eigen")
      set(of_link eigen)
    elseif(link STREQUAL "nlohmann_json::nlohmann_json")
      set(of_link json)
    elseif(link MATCHES "^mixrig::")
      get_target_property(linked ${link} ALIASED_TARGET)
      get_target_property(of_link ${linked} MIXRIG_PCH_KIND)
    endif()
    list(FIND MIXRIG_PCH_KINDS "${of_link}" level)
    if(level GREATER highest)
      set(highest ${level})
    endif()
  endforeach()
  list(GET MIXRIG_PCH_KINDS ${highest} which)
  set_target_properties(${target} PROPERTIES MIXRIG_PCH_KIND ${which})
  mixrig_precompile(${target} ${which})
endfunction()
