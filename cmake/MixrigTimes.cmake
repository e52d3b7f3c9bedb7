# SPDX-License-Identifier: Apache-2.0
# Records the time of each compilation, link and test for ./check, which sums it up in
# build/PRESET/times.csv. GNU time appends a line to times.log: "build|TARGET|..." or "test|PROGRAM
# and its arguments|...".
find_program(MIXRIG_GNU_TIME time)
if(NOT MIXRIG_GNU_TIME)
  return()
endif()
set(timed ${MIXRIG_GNU_TIME} -q -a -o ${CMAKE_BINARY_DIR}/times.log -f)
list(JOIN timed " " launch)
foreach(rule COMPILE LINK)
  set_property(GLOBAL PROPERTY RULE_LAUNCH_${rule} "${launch} \"build|<TARGET_NAME>|%U|%S|%e|%M\"")
endforeach()
if(NOT CMAKE_CROSSCOMPILING)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${timed} "test|%C|%U|%S|%e|%M")  # before each program of a test
endif()
