// SPDX-License-Identifier: Apache-2.0
// Resident memory of this process.
#pragma once

#include <fstream>
#include <string>

#include <unistd.h>

namespace mixrig::test {

/// Megabytes (2^20 bytes) that are resident now, from /proc/self/statm.
inline double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  long total_pages = 0, resident_pages = 0;
  statm >> total_pages >> resident_pages;
  return static_cast<double>(resident_pages) * static_cast<double>(::sysconf(_SC_PAGESIZE)) /
         (1 << 20);
}

}  // namespace mixrig::test
