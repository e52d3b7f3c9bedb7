// SPDX-License-Identifier: Apache-2.0
// Lets Ctrl-C, and a terminal that is closed, end long work with a complete output.
#pragma once

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace mixrig::tools {

/// While the object exists, the first SIGINT, SIGTERM or SIGHUP sets flag(), which others may set
/// too; nohup(1) still keeps SIGHUP away. Another SIGINT or SIGTERM half a second later or more
/// ends the process. SIGPIPE is ignored, since what reads the output dies with the terminal. The
/// destructor restores the old handlers. One object at a time.
class StopOnSignal {
 public:
  StopOnSignal() {
    flag_ = false;
    old_int_ = std::signal(SIGINT, stop);
    old_term_ = std::signal(SIGTERM, stop);
    old_pipe_ = std::signal(SIGPIPE, SIG_IGN);
    old_hangup_ = std::signal(SIGHUP, stop);
    if (old_hangup_ == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  }
  ~StopOnSignal() {
    std::signal(SIGINT, old_int_);
    std::signal(SIGTERM, old_term_);
    std::signal(SIGPIPE, old_pipe_);
    std::signal(SIGHUP, old_hangup_);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;
  static std::atomic<bool>& flag() { return flag_; }

 private:
  static void stop(int signal) {
    const std::int64_t now = now_ms();
    if (!flag_.exchange(true)) first_ms_ = now;
    // Shells and timeout(1) signal a process and its group: both signals count as one.
    if (signal == SIGHUP || now - first_ms_ < kSamePress_ms) return;
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
  static std::int64_t now_ms() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1'000'000;
  }
  static constexpr std::int64_t kSamePress_ms = 500;
  // A signal handler can only use static data.
  static inline std::atomic<bool> flag_ = false;
  static inline std::atomic<std::int64_t> first_ms_ = 0;
  static_assert(std::atomic<bool>::is_always_lock_free);
  void (*old_int_)(int);
  void (*old_term_)(int);
  void (*old_pipe_)(int);
  void (*old_hangup_)(int);
};

}  // namespace mixrig::tools
