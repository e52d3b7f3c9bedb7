# SPDX-License-Identifier: Apache-2.0
# mixrig_room(NAME SOURCES ... [LINKS ...] [PRIVATE_LINKS ...]): the one target of a folder.
# Target mixrig_NAME, alias mixrig::NAME. LINKS are seen by users of its headers.
function(mixrig_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  if(ROOM_SOURCES)
    add_library(mixrig_${name} STATIC ${ROOM_SOURCES})
    target_link_libraries(mixrig_${name} PUBLIC mixrig_options ${ROOM_LINKS}
                                         PRIVATE ${ROOM_PRIVATE_LINKS})
    if("${ROOM_LINKS};${ROOM_PRIVATE_LINKS}" MATCHES "Eigen|geometry|estimation")
      mixrig_precompile(mixrig_${name} eigen)
    else()
      mixrig_precompile(mixrig_${name} std)
    endif()
  else()
    add_library(mixrig_${name} INTERFACE)
    target_link_libraries(mixrig_${name} INTERFACE mixrig_options ${ROOM_LINKS})
  endif()
  add_library(mixrig::${name} ALIAS mixrig_${name})
endfunction()

# mixrig_test(NAME SOURCES ... LINKS ... [LABELS ...]): a GoogleTest program, each case a ctest.
function(mixrig_test name)
  cmake_parse_arguments(T "" "" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(${name} ${T_SOURCES})
  target_link_libraries(${name} PRIVATE mixrig_options ${T_LINKS} GTest::gtest_main)
  mixrig_precompile(${name} test)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${T_LABELS}" TIMEOUT 300
    ENVIRONMENT "MIXRIG_SOURCE=${PROJECT_SOURCE_DIR}")
endfunction()
