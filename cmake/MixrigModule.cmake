# SPDX-License-Identifier: Apache-2.0
# mixrig_module(NAME SOURCES ... [LINKS ...] [PRIVATE_LINKS ...]): the one target of a folder.
# Target mixrig_NAME, alias mixrig::NAME. LINKS are seen by users of its headers.
# A target sees the headers of its own folder and of the modules that it links, and no others: every
# module has a tree of links to its headers, which is its one include directory. Only modules that are
# defined before can be linked, so there are no cycles.
function(mixrig_module name)
  cmake_parse_arguments(MODULE "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  foreach(link IN LISTS MODULE_LINKS MODULE_PRIVATE_LINKS)
    if(link MATCHES "^mixrig::" AND NOT TARGET ${link})
      message(FATAL_ERROR "module ${name} links ${link}, which is not defined before it: see MIXRIG_MODULES in CMakeLists.txt")
    endif()
  endforeach()
  mixrig_header_tree(${name} tree ${MODULE_SOURCES})
  mixrig_compile_group(group)
  if(group)
    mixrig_add_to_group(${group} ${name} ${tree})
  elseif(MODULE_SOURCES)
    add_library(mixrig_${name} STATIC ${MODULE_SOURCES})
    target_link_libraries(mixrig_${name} PUBLIC mixrig_options ${MODULE_LINKS} PRIVATE ${MODULE_PRIVATE_LINKS})
    target_include_directories(mixrig_${name} PUBLIC ${tree})
    if(NOT CMAKE_CURRENT_SOURCE_DIR MATCHES "/firmware/")  # the standard library alone, and the microcontroller's
      mixrig_precompile(mixrig_${name} module)
    endif()
  else()
    add_library(mixrig_${name} INTERFACE)
    target_link_libraries(mixrig_${name} INTERFACE mixrig_options ${MODULE_LINKS})
    target_include_directories(mixrig_${name} INTERFACE ${tree})
  endif()
  add_library(mixrig::${name} ALIAS mixrig_${name})
  mixrig_note_module(${name} "${MODULE_LINKS}" "${MODULE_PRIVATE_LINKS}")
endfunction()

# Links to the headers of this folder and of the inner folders that hold sources of the module.
function(mixrig_header_tree name out)
  set(tree ${PROJECT_BINARY_DIR}/headers/${name})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set(inner "")
  foreach(source IN LISTS ARGN)
    cmake_path(IS_ABSOLUTE source generated)
    cmake_path(GET source PARENT_PATH parent)
    if(parent AND NOT generated)
      list(APPEND inner ${parent}/*.h)
    endif()
  endforeach()
  list(REMOVE_DUPLICATES inner)
  file(GLOB headers RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.h ${inner})
  file(REMOVE_RECURSE ${tree})
  foreach(header IN LISTS headers)
    cmake_path(GET header PARENT_PATH parent)
    file(MAKE_DIRECTORY ${tree}/${folder}/${parent})
    file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR}/${header} ${tree}/${folder}/${header} SYMBOLIC)
  endforeach()
  set(${out} ${tree} PARENT_SCOPE)
endfunction()

# Module lists for the house tests and the table in ARCHITECTURE.md: "folder|links|private links"
function(mixrig_note_module name links private_links)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set_property(GLOBAL APPEND_STRING PROPERTY MIXRIG_MODULE_LINES
    "${name}|${folder}|${links}|${private_links}\n")
endfunction()

# mixrig_test(PROGRAM SOURCES ... LINKS ...): a folder's tests in a GoogleTest program, each case a ctest.
# Folders share the programs that tests/CMakeLists.txt lists by label: a program's precompiled header,
# batches and link cost as much as several files of tests.
function(mixrig_test program)
  cmake_parse_arguments(T "" "" "SOURCES;LINKS" ${ARGN})
  if(T_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "mixrig_test(${program}): what is ${T_UNPARSED_ARGUMENTS}? use SOURCES and LINKS")
  endif()
  if(NOT TARGET ${program})
    mixrig_test_program(${program})
  endif()
  list(TRANSFORM T_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ REGEX "^[^/]")
  target_sources(${program} PRIVATE ${T_SOURCES})
  target_link_libraries(${program} PRIVATE ${T_LINKS})
  mixrig_note_test(${program} ${T_LINKS})
endfunction()

# mixrig_note_test(NAME MODULES ...): for ./check --changed: tests "NAME.*", whose files lie in this
# folder, depend on these modules.
function(mixrig_note_test name)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set_property(GLOBAL APPEND PROPERTY MIXRIG_TESTS ${name})
  set_property(GLOBAL APPEND PROPERTY MIXRIG_TEST_LINKS_${name} ${ARGN})
  set_property(GLOBAL APPEND PROPERTY MIXRIG_TEST_FOLDERS_${name} ${folder})
endfunction()

function(mixrig_test_program program)
  foreach(candidate IN LISTS MIXRIG_TEST_LABELS)
    if(program IN_LIST MIXRIG_${candidate}_TESTS)
      set(label ${candidate})
    endif()
  endforeach()
  if(NOT label)
    message(FATAL_ERROR "test program ${program} is in no list of tests/CMakeLists.txt")
  endif()
  add_executable(${program})
  target_link_libraries(${program} PRIVATE mixrig_options GTest::gtest_main)
  mixrig_precompile(${program} test)
  set_target_properties(${program} PROPERTIES UNITY_BUILD_BATCH_SIZE 16)  # where batches are made at all
  set(timeout_s 300)
  if(label STREQUAL "long_take")
    set(timeout_s 900)  # the longest last 4 minutes on two cores
  endif()
  if(MIXRIG_SANITIZE)
    set(timeout_s 1200)  # whole takes last up to twelve times as long
  endif()
  mixrig_left_out(out ${label} ${program})
  if(out)
    return()
  endif()
  if(NOT MIXRIG_SLOW_${program})
    mixrig_cases("*" ${label})
    return()
  endif()
  list(JOIN MIXRIG_SLOW_${program} ":" slow)
  mixrig_cases("-${slow}" ${label})
  mixrig_left_out(out ${label}_slow)
  if(NOT out)
    mixrig_cases("${slow}" ${label}_slow)
  endif()
endfunction()

# mixrig_left_out(OUT LABEL [TARGET ...]): whether tests of this label are left out (MIXRIG_TESTS_LEFT_OUT);
# the targets, which only they need, are then built where something asks for them.
function(mixrig_left_out out label)
  set(${out} OFF PARENT_SCOPE)
  if(MIXRIG_TESTS_LEFT_OUT AND label MATCHES "${MIXRIG_TESTS_LEFT_OUT}")
    set(${out} ON PARENT_SCOPE)
    if(ARGN)
      set_target_properties(${ARGN} PROPERTIES EXCLUDE_FROM_ALL ON)
    endif()
  endif()
endfunction()

# For mixrig_test_program(), whose program and timeout_s it reads: the cases of a filter of GoogleTest.
function(mixrig_cases filter label)
  gtest_discover_tests(${program} DISCOVERY_TIMEOUT 60 TEST_PREFIX "${program}." TEST_FILTER "${filter}"
    PROPERTIES LABELS ${label} TIMEOUT ${timeout_s}
    ENVIRONMENT "MIXRIG_SOURCE=${PROJECT_SOURCE_DIR}"
    ENVIRONMENT_MODIFICATION "MIXRIG_TAKES=set:${PROJECT_BINARY_DIR}/takes")
endfunction()

# mixrig_runs_command(PROGRAM): its tests run `mixrig`.
function(mixrig_runs_command program)
  target_compile_definitions(${program} PRIVATE MIXRIG_COMMAND="$<TARGET_FILE:mixrig>"
    MIXRIG_STUDIO_TAKE="${PROJECT_SOURCE_DIR}/tests/support/studio_take")
  add_dependencies(${program} mixrig)
  mixrig_note_test(${program} mixrig::tools)
endfunction()
