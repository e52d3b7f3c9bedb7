// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

namespace mixrig::fuzz {

/// Takes `size` bytes at `data`; aborts when the code under test answers wrongly. Returns 0.
using Target = int (*)(const std::uint8_t* data, std::size_t size);

/// Makes a target known to fuzz_replay by its name. Returns true.
bool add_target(const char* name, Target target);

}  // namespace mixrig::fuzz

/// MIXRIG_FUZZ_TARGET(name) { ... }: the function that libFuzzer calls; in builds without it, one
/// of the targets of fuzz_replay. The body sees `data` and `size`.
#ifdef MIXRIG_LIBFUZZER
#define MIXRIG_FUZZ_TARGET(name) \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
#else
#define MIXRIG_FUZZ_TARGET(name)                                                                  \
  static int fuzz_##name(const std::uint8_t* data, std::size_t size);                             \
  [[maybe_unused]] static const bool added_##name = mixrig::fuzz::add_target(#name, fuzz_##name); \
  static int fuzz_##name(const std::uint8_t* data, std::size_t size)
#endif
