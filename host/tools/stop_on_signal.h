// SPDX-License-Identifier: Apache-2.0
// Ctrl-C ends long work with a whole output.
#pragma once

#include <atomic>
#include <csignal>

namespace mixrig::tools {

/// While it lives, the first SIGINT or SIGTERM sets flag(); a second one kills, as ever. The old
/// handlers come back after it. One at a time.
class StopOnSignal {
 public:
  StopOnSignal() {
    flag_ = false;
    old_int_ = std::signal(SIGINT, stop);
    old_term_ = std::signal(SIGTERM, stop);
  }
  ~StopOnSignal() {
    std::signal(SIGINT, old_int_);
    std::signal(SIGTERM, old_term_);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;
  static const std::atomic<bool>& flag() { return flag_; }

 private:
  static void stop(int signal) {
    flag_ = true;
    std::signal(signal, SIG_DFL);
  }
  // A signal handler reaches nothing but what is static.
  static inline std::atomic<bool> flag_ = false;
  static_assert(std::atomic<bool>::is_always_lock_free);
  void (*old_int_)(int);
  void (*old_term_)(int);
};

}  // namespace mixrig::tools
