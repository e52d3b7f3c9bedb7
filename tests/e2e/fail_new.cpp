// SPDX-License-Identifier: Apache-2.0
// Preloaded by fail_call_test.py. The allocation with the number in MIXRIG_FAIL_NEW fails; the
// number of allocations goes to the file in MIXRIG_COUNT_NEW when the program ends. Counted is what
// the program, the standard library and those of pictures take, by operator new and by malloc:
// GLib ends a program without memory, and glibc keeps its lock where a plug-in that it loads
// throws.
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include <link.h>

extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
}

namespace {

struct Code {
  std::uintptr_t begin = 0, end = 0;
};
std::array<Code, 16> counted_code;  ///< filled before main(); until then nothing is counted
std::atomic<long> made = 0;

bool is_counted(const char* module) {
  if (*module == '\0') return true;  // the program itself
  for (const char* name : {"/libstdc++", "/libpng", "/libz.", "/libjpeg", "/libOpenEXR", "/libyuv"})
    if (std::strstr(module, name) != nullptr) return true;
  return false;
}

int add_code(dl_phdr_info* module, std::size_t, void* next) {
  auto& at = *static_cast<std::size_t*>(next);
  for (int i = 0; i < module->dlpi_phnum && at < counted_code.size(); ++i) {
    const auto& part = module->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0 || !is_counted(module->dlpi_name))
      continue;
    const std::uintptr_t begin = module->dlpi_addr + part.p_vaddr;
    counted_code[at++] = {begin, begin + part.p_memsz};
  }
  return 0;
}

long number_that_fails() {
  static const long number = [] {
    const char* const text = std::getenv("MIXRIG_FAIL_NEW");
    return text != nullptr ? std::atol(text) : 0;
  }();
  return number;
}

bool fails() {
  if (++made != number_that_fails()) return false;
  errno = ENOMEM;
  return true;
}

bool fails_for(const void* caller) {
  const auto at = reinterpret_cast<std::uintptr_t>(caller);
  for (const Code& code : counted_code)
    if (at >= code.begin && at < code.end) return fails();
  return false;
}

struct Count {
  Count() {
    std::size_t next = 0;
    dl_iterate_phdr(add_code, &next);
  }
  ~Count() {
    const char* const path = std::getenv("MIXRIG_COUNT_NEW");
    std::FILE* const file = path != nullptr ? std::fopen(path, "w") : nullptr;
    if (file == nullptr) return;
    std::fprintf(file, "%ld\n", made.load());
    std::fclose(file);
  }
} count;

}  // namespace

extern "C" {
void* malloc(std::size_t bytes) {
  return fails_for(__builtin_return_address(0)) ? nullptr : __libc_malloc(bytes);
}
void* calloc(std::size_t n, std::size_t bytes) {
  return fails_for(__builtin_return_address(0)) ? nullptr : __libc_calloc(n, bytes);
}
void* realloc(void* memory, std::size_t bytes) {
  return fails_for(__builtin_return_address(0)) ? nullptr : __libc_realloc(memory, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  return fails_for(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, bytes);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) {
  if (fails_for(__builtin_return_address(0))) return ENOMEM;
  *memory = __libc_memalign(alignment, bytes);
  return *memory == nullptr ? ENOMEM : 0;
}
}

void* operator new(std::size_t bytes) {
  const void* const caller = __builtin_return_address(0);
  void* const memory = fails_for(caller) ? nullptr : __libc_malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  const void* const caller = __builtin_return_address(0);
  void* const memory =
      fails_for(caller) ? nullptr : __libc_memalign(static_cast<std::size_t>(alignment), bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
