// SPDX-License-Identifier: Apache-2.0
// What a function says where memory ends.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "hal/base/result.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kLimitsMemory = false;  // a sanitizer needs terabytes of addresses
#else
inline constexpr bool kLimitsMemory = true;
#endif

namespace mixrig::test {

/// Calls work(), which returns a Result, with at most `bytes` more of addresses, prints its error
/// on stderr, and ends the process: status 0 where it failed. For EXPECT_EXIT.
template <typename Work>
[[noreturn]] void say_with_little_memory(rlim_t bytes, Work&& work) {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit limit{most, most};
  if (::setrlimit(RLIMIT_AS, &limit) != 0) std::exit(2);
  const auto done = work();
  if (done) std::exit(1);
  std::fputs(to_line(done.error()).c_str(), stderr);
  std::exit(0);
}

}  // namespace mixrig::test
