# SPDX-License-Identifier: Apache-2.0
# Checks that docs/reference/commands.md is what `mixrig help-pages` writes, and that each command
# has a man page.
file(REMOVE_RECURSE ${FOLDER})
execute_process(COMMAND ${PROGRAM} help-pages ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${FOLDER}/commands.md ${PAGE} RESULT_VARIABLE differs)
if(differs)
  message(SEND_ERROR "${PAGE} is not what the program writes: mixrig help-pages DIR, then copy DIR/commands.md")
endif()
file(STRINGS ${FOLDER}/commands.md headings REGEX "^##+ mixrig ")
foreach(heading IN LISTS headings)
  string(REGEX REPLACE "^#+ " "" page "${heading}")
  string(REPLACE " " "-" page "${page}")
  if(NOT EXISTS ${FOLDER}/${page}.1)
    message(SEND_ERROR "${page}.1 is missing")
  endif()
endforeach()
