// SPDX-License-Identifier: Apache-2.0
// A build for a newer processor than this one ends with one error line, not by SIGILL.
#if defined(__x86_64__)
#include <cstring>

#include <unistd.h>

#include "hal/base/cpu_level.h"

namespace mixrig::tools {
namespace {

#define MIXRIG_BASELINE __attribute__((target("arch=x86-64")))

/// This code must not use the instructions of the level, nor may any included code.
MIXRIG_BASELINE bool has_level() {
  __builtin_cpu_init();
#if defined(__AVX512F__)
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512bw") ||
      !__builtin_cpu_supports("avx512cd") || !__builtin_cpu_supports("avx512dq") ||
      !__builtin_cpu_supports("avx512vl"))
    return false;
#endif
#if defined(__AVX2__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi2") ||
      !__builtin_cpu_supports("fma"))
    return false;
#endif
#if defined(__SSE4_2__)
  if (!__builtin_cpu_supports("sse4.2") || !__builtin_cpu_supports("popcnt")) return false;
#endif
  return true;
}

/// Runs before the constructors of static objects, which may use the level's instructions.
__attribute__((constructor(101))) MIXRIG_BASELINE void check_processor() {
  if (has_level()) return;
  static constexpr char kLine[] =
      "mixrig: this program is built for " MIXRIG_CPU_LEVEL
      " and this processor is older: build it on this machine, or with MIXRIG_MARCH=x86-64\n";
  const auto written = write(STDERR_FILENO, kLine, sizeof kLine - 1);
  _exit(written < 0 ? 1 : 2);
}

}  // namespace
}  // namespace mixrig::tools
#endif
