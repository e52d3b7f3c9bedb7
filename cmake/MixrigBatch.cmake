# SPDX-License-Identifier: Apache-2.0
# For builds from nothing (./check, ./demo): most files spend their time on the same headers and
# templates. These are precompiled, and the files of a room are compiled eight at a time (a unity
# build), so that names in anonymous namespaces are unique in a room. Off by default: an edit in the
# tree is then compiled alone and with its own includes only, and ccache is of more use.
option(MIXRIG_BATCH "Precompiled headers, and several files of a room in one compilation" OFF)
if(NOT MIXRIG_BATCH OR MIXRIG_FUZZ)
  function(mixrig_precompile)
  endfunction()
  function(mixrig_precompile_room)
  endfunction()
  return()
endif()

set(CMAKE_UNITY_BUILD ON)
set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)
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
# Each kind holds what the one before it holds; none is for the firmware, which has neither.
set(MIXRIG_PCH_KINDS none eigen json)
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
    if(link MATCHES "^(fmt::fmt|Eigen3::Eigen)$")
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
  if(NOT which STREQUAL "none")
    mixrig_precompile(${target} ${which})
  endif()
endfunction()
