// SPDX-License-Identifier: Apache-2.0
// Preloaded by fail_call_test.py. The allocation by operator new with the number in MIXRIG_FAIL_NEW
// fails; the number of allocations goes to the file in MIXRIG_COUNT_NEW when the program ends.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long> made = 0;

long number_that_fails() {
  static const long number = [] {
    const char* const text = std::getenv("MIXRIG_FAIL_NEW");
    return text != nullptr ? std::atol(text) : 0;
  }();
  return number;
}

struct Count {
  ~Count() {
    const char* const path = std::getenv("MIXRIG_COUNT_NEW");
    std::FILE* const file = path != nullptr ? std::fopen(path, "w") : nullptr;
    if (file == nullptr) return;
    std::fprintf(file, "%ld\n", made.load());
    std::fclose(file);
  }
} count;

}  // namespace

void* operator new(std::size_t bytes) {
  void* const memory = ++made == number_that_fails() ? nullptr : std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
