# SPDX-License-Identifier: Apache-2.0
# cmake -DLD= -DOBJCOPY= -DNM= -DOBJDUMP= -DKEEP=SYMBOL -DOUT=FILE -P merge_level.cmake -- OBJECT ...
# Merges all objects into one in which only SYMBOL is visible. Fails if anything else is visible, or
# if any of its code would run before main on a processor that may lack its instructions.
set(objects "")
set(is_object OFF)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE ${last})
  if(is_object)
    list(APPEND objects ${CMAKE_ARGV${i}})
  elseif(CMAKE_ARGV${i} STREQUAL "--")
    set(is_object ON)
  endif()
endforeach()

function(run out)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output ERROR_VARIABLE error RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${ARGN}: ${error}")
  endif()
  set(${out} "${output}" PARENT_SCOPE)
endfunction()

# Linkers match copies of a function by its group name, even if it is local; so all groups are
# removed.
run(ignored ${LD} -r --force-group-allocation -o ${OUT}.all ${objects})
run(ignored ${OBJCOPY} --keep-global-symbol=${KEEP} ${OUT}.all ${OUT})
file(REMOVE ${OUT}.all)

run(seen ${NM} --defined-only --extern-only --format=just-symbols ${OUT})
string(STRIP "${seen}" seen)
if(NOT seen STREQUAL KEEP)
  file(REMOVE ${OUT})
  message(FATAL_ERROR "${OUT}: more than ${KEEP} can be seen from outside:\n${seen}")
endif()
run(sections ${OBJDUMP} -h ${OUT})
if(sections MATCHES "\\.(init_array|ctors|preinit_array)")
  file(REMOVE ${OUT})
  message(FATAL_ERROR "${OUT}: static objects have constructors, which would run on every processor")
endif()
