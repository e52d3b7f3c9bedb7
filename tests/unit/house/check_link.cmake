# SPDX-License-Identifier: Apache-2.0
# Checks that Ceres stays in its shared library and uses no Eigen function of ours
# (cmake/MixrigCeres.cmake). usage: cmake -DNM=nm -DPROGRAM=FILE -P check_link.cmake
execute_process(COMMAND ${NM} --defined-only ${PROGRAM} OUTPUT_VARIABLE defined ERROR_QUIET)
execute_process(COMMAND ${NM} --dynamic --defined-only ${PROGRAM} OUTPUT_VARIABLE exported ERROR_QUIET)
if(defined STREQUAL "")
  message(FATAL_ERROR "${PROGRAM} has no names to check")
endif()
if(defined MATCHES " [TtWw] _ZN5ceres5SolveE")
  message(FATAL_ERROR "${PROGRAM} holds ceres::Solve: link libceres.so, not libceres.a")
endif()
if(exported MATCHES "(_ZNK?5Eigen[A-Za-z0-9_]+)")
  message(FATAL_ERROR "${PROGRAM} exports ${CMAKE_MATCH_1}: see cmake/keep_eigen_inside.map")
endif()
