# SPDX-License-Identifier: Apache-2.0
# Writes OUT, a C++ file with a table of the files of folder IN and of the file MORE. A string literal may have 64 KiB:
# longer files are given in pieces.
cmake_minimum_required(VERSION 3.25)
file(GLOB files RELATIVE ${IN} ${IN}/*)
list(SORT files)
list(APPEND files ${MORE})
set(table "")
foreach(name IN LISTS files)
  cmake_path(ABSOLUTE_PATH name BASE_DIRECTORY ${IN} OUTPUT_VARIABLE path)
  cmake_path(GET name FILENAME name)
  file(READ ${path} rest)
  set(pieces "")
  string(LENGTH "${rest}" length)
  set(at 0)
  while(at LESS length)
    string(SUBSTRING "${rest}" ${at} 8000 piece)
    string(APPEND pieces "R\"page(${piece})page\" ")
    math(EXPR at "${at} + 8000")
  endwhile()
  string(APPEND table "    {\"${name}\", ${pieces}},\n")
endforeach()
file(WRITE ${OUT}.new "// Made by host/operator/page/embed.cmake.
#include \"host/operator/page/files.h\"

namespace mixrig::page {
const std::vector<File>& all_files() {
  static const std::vector<File> files = {
${table}  };
  return files;
}
}  // namespace mixrig::page
")
file(RENAME ${OUT}.new ${OUT})
