# SPDX-License-Identifier: Apache-2.0
# Fails when a compile command leaves the processor to the machine that it runs on (-march=native).
# COMMANDS: a compile_commands.json
cmake_minimum_required(VERSION 3.25)
file(STRINGS ${COMMANDS} native REGEX "\"command\".* -m(arch|cpu|tune)=native")
list(LENGTH native count)
if(count)
  list(GET native 0 first)
  message(FATAL_ERROR "${count} command(s) with native: a shared compiler cache would hand out objects made for "
    "another processor: see cmake/MixrigMarch.cmake\n  ${first}")
endif()
