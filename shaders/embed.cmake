# SPDX-License-Identifier: Apache-2.0
# Writes OUT/shaders_embedded.cpp (a table of all stages) and OUT/expanded/NAME (each as it is
# compiled). `#include "common/x.glsl"` is replaced by the file; `#line` keeps lines and numbers the
# files of a stage (0 = the stage itself), so that a compile error names file and line.
# OUT/common/constants.glsl is made from the C++ headers CONSTANTS (separated by commas): each line
# `inline constexpr TYPE kName = VALUE;` becomes `const TYPE name = VALUE;`.
cmake_minimum_required(VERSION 3.25)

# Converts a constant of a C++ header to GLSL; doubles become floats.
function(to_glsl definition out)
  string(REGEX MATCH "constexpr (int|float|double) k([A-Za-z0-9]+) = ([-0-9.e]+)" found "${definition}")
  set(type ${CMAKE_MATCH_1})
  set(value ${CMAKE_MATCH_3})
  string(REGEX REPLACE "([A-Z])" "_\\1" name ${CMAKE_MATCH_2})
  string(TOLOWER ${name} name)
  string(REGEX REPLACE "^_" "" name ${name})
  if(NOT type STREQUAL "int")
    set(type float)
  endif()
  set(${out} "const ${type} ${name} = ${value};\n" PARENT_SCOPE)
endfunction()

function(write_constants)
  set(text "// SPDX-License-Identifier: Apache-2.0\n// Made by shaders/embed.cmake.\n")
  string(REPLACE "," ";" headers ${CONSTANTS})
  foreach(header IN LISTS headers)
    file(STRINGS ${header} definitions
         REGEX "^inline constexpr (int|float|double) k[A-Za-z0-9]+ = [-0-9.e]+F?;")
    foreach(definition IN LISTS definitions)
      to_glsl("${definition}" line)
      string(APPEND text "${line}")
    endforeach()
  endforeach()
  file(WRITE ${OUT}/common/constants.glsl "${text}")
endfunction()

# Builds the text of stage `name` with its includes, and the list of files that its numbers mean.
function(expand name out_text out_files)
  file(READ ${IN}/${name} rest)
  set(done "")
  set(files ${name})
  set(line 1)
  while(rest MATCHES "\n#include \"([^\"]+)\"")
    set(header ${CMAKE_MATCH_1})
    string(FIND "${rest}" "\n#include \"${header}\"" at)
    string(SUBSTRING "${rest}" 0 ${at} before)
    string(LENGTH "\n#include \"${header}\"" skip)
    math(EXPR at "${at} + ${skip}")
    string(SUBSTRING "${rest}" ${at} -1 rest)
    string(REGEX MATCHALL "\n" newlines "${before}")
    list(LENGTH newlines lines)
    math(EXPR line "${line} + ${lines} + 1")
    math(EXPR next "${line} + 1")
    list(LENGTH files number)
    list(APPEND files ${header})
    if(EXISTS ${OUT}/${header})
      file(READ ${OUT}/${header} body)
    else()
      file(READ ${IN}/${header} body)
    endif()
    string(APPEND done "${before}\n#line 1 ${number}\n${body}#line ${next} 0")
  endwhile()
  set(${out_text} "${done}${rest}" PARENT_SCOPE)
  set(${out_files} "${files}" PARENT_SCOPE)
endfunction()

write_constants()
file(GLOB stages RELATIVE ${IN} ${IN}/*.vert ${IN}/*.frag ${IN}/*.comp)
list(SORT stages)
set(table "")
foreach(stage IN LISTS stages)
  expand(${stage} text files)
  file(WRITE ${OUT}/expanded/${stage} "${text}")
  list(JOIN files "\", \"" names)
  string(APPEND table "    {\"${stage}\", R\"glsl(${text})glsl\", {\"${names}\"}},\n")
endforeach()
file(WRITE ${OUT}/shaders_embedded.cpp.new "// Made by shaders/embed.cmake.
#include \"shaders/shaders.h\"

namespace mixrig::shaders {
const std::vector<Stage>& all_stages() {
  static const std::vector<Stage> stages = {
${table}  };
  return stages;
}
}  // namespace mixrig::shaders
")
file(RENAME ${OUT}/shaders_embedded.cpp.new ${OUT}/shaders_embedded.cpp)
