// SPDX-License-Identifier: Apache-2.0
#include "tests/support/count_allocations.h"

#include <cstdlib>
#include <new>

namespace mixrig::test {

std::atomic<long> allocations{0};
thread_local long own_allocations = 0;

}  // namespace mixrig::test

// These stand in a separate file: if inlined, the compiler would warn of mismatched allocation
// functions.
void* operator new(std::size_t size) {
  ++mixrig::test::allocations;
  ++mixrig::test::own_allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++mixrig::test::allocations;
  ++mixrig::test::own_allocations;
  return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
