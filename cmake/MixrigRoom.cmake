# SPDX-License-Identifier: Apache-2.0
# mixrig_room(NAME SOURCES ... [LINKS ...] [PRIVATE_LINKS ...]): the one target of a folder.
# Target mixrig_NAME, alias mixrig::NAME. LINKS are seen by users of its headers.
# A target sees the headers of its own folder and of the rooms that it links, and no others: every
# room has a tree of links to its headers, which is its one include directory. Only rooms that are
# defined before can be linked, so there are no cycles.
function(mixrig_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  foreach(link IN LISTS ROOM_LINKS ROOM_PRIVATE_LINKS)
    if(link MATCHES "^mixrig::" AND NOT TARGET ${link})
      message(FATAL_ERROR "room ${name} links ${link}, which is not defined before it: see MIXRIG_ROOMS in CMakeLists.txt")
    endif()
  endforeach()
  mixrig_header_tree(${name} tree ${ROOM_SOURCES})
  if(ROOM_SOURCES)
    add_library(mixrig_${name} STATIC ${ROOM_SOURCES})
    target_link_libraries(mixrig_${name} PUBLIC mixrig_options ${ROOM_LINKS} PRIVATE ${ROOM_PRIVATE_LINKS})
    target_include_directories(mixrig_${name} PUBLIC ${tree})
    if(NOT CMAKE_CURRENT_SOURCE_DIR MATCHES "/firmware/")  # the standard library alone, and the microcontroller's
      mixrig_precompile(mixrig_${name} room)
    endif()
  else()
    add_library(mixrig_${name} INTERFACE)
    target_link_libraries(mixrig_${name} INTERFACE mixrig_options ${ROOM_LINKS})
    target_include_directories(mixrig_${name} INTERFACE ${tree})
  endif()
  add_library(mixrig::${name} ALIAS mixrig_${name})
  mixrig_note_room(${name} "${ROOM_LINKS}" "${ROOM_PRIVATE_LINKS}")
endfunction()

# Links to the headers of this folder and of the inner folders that hold sources of the room.
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

# What the house tests and the table in ARCHITECTURE.md are held against: "folder|links|private links"
function(mixrig_note_room name links private_links)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set_property(GLOBAL APPEND_STRING PROPERTY MIXRIG_ROOM_LINES
    "${name}|${folder}|${links}|${private_links}\n")
endfunction()

# mixrig_test(NAME SOURCES ... LINKS ... [LABELS ...]): a GoogleTest program, each case a ctest.
function(mixrig_test name)
  cmake_parse_arguments(T "" "" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(${name} ${T_SOURCES})
  target_link_libraries(${name} PRIVATE mixrig_options ${T_LINKS} GTest::gtest_main)
  mixrig_precompile(${name} test)
  set(timeout_s 300)
  if("long_take" IN_LIST T_LABELS)
    set(timeout_s 900)  # the longest last 4 minutes on two cores
  endif()
  if(MIXRIG_SANITIZE)
    set(timeout_s 1200)  # whole takes last up to twelve times as long
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${T_LABELS}" TIMEOUT ${timeout_s}
    ENVIRONMENT "MIXRIG_SOURCE=${PROJECT_SOURCE_DIR}")
endfunction()
