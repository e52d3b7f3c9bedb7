# SPDX-License-Identifier: Apache-2.0
# Precompiled headers, for builds from nothing (./check, ./demo): most files spend their time on
# the same headers. Off by default: an edit in the tree is then compiled with its own includes only,
# and ccache is of more use.
option(MIXRIG_PCH "Precompile the standard library, Eigen and GoogleTest" OFF)
if(NOT MIXRIG_PCH OR MIXRIG_FUZZ)
  function(mixrig_precompile)
  endfunction()
  function(mixrig_precompile_room)
  endfunction()
  return()
endif()

add_compile_options(-pthread)  # the same for all, or a header would not be taken
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

find_package(Eigen3 REQUIRED NO_MODULE)
mixrig_pch(std)
mixrig_pch(eigen HEADERS <Eigen/Dense> LINKS Eigen3::Eigen)
if(MIXRIG_TESTS)
  find_package(GTest REQUIRED)
  mixrig_pch(test HEADERS <Eigen/Dense> <gtest/gtest.h> LINKS Eigen3::Eigen GTest::gtest)
endif()

# mixrig_precompile(TARGET WHICH): WHICH is std, eigen or test.
function(mixrig_precompile target which)
  target_precompile_headers(${target} REUSE_FROM mixrig_pch_${which})
endfunction()

# mixrig_precompile_room(TARGET LINKS ...): eigen for a room that links Eigen, itself or through others.
function(mixrig_precompile_room target)
  set(which std)
  foreach(link IN LISTS ARGN)
    if(link STREQUAL "Eigen3::Eigen")
      set(which eigen)
    elseif(link MATCHES "^mixrig::")
      get_target_property(linked ${link} ALIASED_TARGET)
      get_target_property(of_link ${linked} MIXRIG_PCH_KIND)
      if(of_link STREQUAL "eigen")
        set(which eigen)
      endif()
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES MIXRIG_PCH_KIND ${which})
  mixrig_precompile(${target} ${which})
endfunction()
