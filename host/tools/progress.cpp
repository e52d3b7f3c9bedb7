// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <unistd.h>

#include "host/tools/command.h"

namespace mixrig::tools {

Progress::Progress(std::string what, int total)
    : what_(std::move(what)), total_(std::max(total, 1)), shown_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
}

void Progress::step(int done, double seconds_left) {
  if (!shown_) return;
  constexpr int kCells = 30;
  const int full = kCells * std::clamp(done, 0, total_) / total_;
  const std::string bar = std::string(static_cast<std::size_t>(full), '#') +
                          std::string(static_cast<std::size_t>(kCells - full), '.');
  std::fprintf(stderr, "\r%s [%s] %d/%d", what_.c_str(), bar.c_str(), done, total_);
  if (const long left_s = std::lround(seconds_left); left_s > 0)
    std::fprintf(stderr, ", %ld:%02ld left\033[K", left_s / 60, left_s % 60);
  std::fflush(stderr);
}

}  // namespace mixrig::tools
