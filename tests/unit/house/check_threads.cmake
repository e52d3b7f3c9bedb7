# SPDX-License-Identifier: Apache-2.0
# Fails if a file starts a thread and guards none of its work (hal/base/guarded.h): what such a
# thread throws ends the process. ROOT: the tree to check.
cmake_minimum_required(VERSION 3.25)
set(breaches "")
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/hal/*.h ${ROOT}/hal/*.cpp ${ROOT}/host/*.h ${ROOT}/host/*.cpp
  ${ROOT}/extras/*.h ${ROOT}/extras/*.cpp ${ROOT}/studio/*.h ${ROOT}/studio/*.cpp)
foreach(file IN LISTS files)
  file(READ ${ROOT}/${file} text)
  if(text MATCHES "std::j?thread[({]|std::async|thread_[({]\\[|workers_\\.emplace_back|pthread_create"
     AND NOT text MATCHES "guarded(_thread)?\\(")
    string(APPEND breaches "\n  ${file}")
  endif()
endforeach()
if(breaches)
  message(FATAL_ERROR "a thread without a guard:${breaches}")
endif()
