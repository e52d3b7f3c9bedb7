# SPDX-License-Identifier: Apache-2.0
# Builds the cpu back end for several levels of x86-64 into one program, which selects the best
# level when it makes a compositor. Functions of shared headers (glm, the standard library, Image)
# are also compiled for each level, and a linker would keep one copy of each. Therefore all objects
# of a level are merged into one, in which every symbol except its entry (back_end.h) is local.
set(MIXRIG_CPU_LEVELS "OFF" CACHE BOOL "The cpu back end for x86-64-v3 and -v4 too, chosen when it runs")

# mixrig_cpu_levels(TARGET SOURCES ...)
function(mixrig_cpu_levels target)
  if(NOT MIXRIG_CPU_LEVELS)
    return()
  endif()
  if(CMAKE_CROSSCOMPILING OR NOT CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64" OR
     NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU" OR MIXRIG_SANITIZE)
    message(FATAL_ERROR "MIXRIG_CPU_LEVELS needs g++ on x86-64, without sanitizers")
  endif()
  find_program(MIXRIG_GNU_LD ld.bfd REQUIRED)
  foreach(level x86-64-v3 x86-64-v4)
    string(MAKE_C_IDENTIFIER ${level} id)
    set(objects ${target}_${id})
    add_library(${objects} OBJECT ${ARGN})
    target_link_libraries(${objects} PRIVATE $<TARGET_PROPERTY:${target},LINK_LIBRARIES>)
    target_include_directories(${objects} PRIVATE $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
    target_compile_options(${objects} PRIVATE $<TARGET_PROPERTY:${target},COMPILE_OPTIONS> -march=${level}
      -fno-gnu-unique)  # such symbols stay to be seen
    # Setups and frames must have the same memory layout as in the rest of the program: Eigen's
    # alignment depends on the level and is 16 bytes at the lowest one (back_end.h checks).
    target_compile_definitions(${objects} PRIVATE MIXRIG_CPU_BACK_END=mixrig_cpu_${id}
      EIGEN_MAX_ALIGN_BYTES=16)
    set(merged ${CMAKE_CURRENT_BINARY_DIR}/${id}.o)
    add_custom_command(OUTPUT ${merged} DEPENDS ${objects} $<TARGET_OBJECTS:${objects}> VERBATIM
      COMMAND_EXPAND_LISTS
      COMMAND ${CMAKE_COMMAND} -DLD=${MIXRIG_GNU_LD} -DOBJCOPY=${CMAKE_OBJCOPY} -DNM=${CMAKE_NM} -DOBJDUMP=${CMAKE_OBJDUMP}
        -DKEEP=mixrig_cpu_${id} -DOUT=${merged} -P ${PROJECT_SOURCE_DIR}/cmake/merge_level.cmake
        -- $<TARGET_OBJECTS:${objects}>)
    set_source_files_properties(${merged} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
    target_sources(${target} PRIVATE ${merged})
  endforeach()
  target_compile_definitions(${target} PRIVATE MIXRIG_CPU_LEVELS)
endfunction()
