// SPDX-License-Identifier: Apache-2.0
// SIGUSR1 as a request to a running command.
#pragma once

#include <atomic>
#include <csignal>

namespace mixrig::tools {

/// While the object exists, each SIGUSR1 counts; others may count as well. The destructor restores
/// the old handler. One object at a time.
class CountSignals {
 public:
  CountSignals() : old_(std::signal(SIGUSR1, add)) {}
  ~CountSignals() { std::signal(SIGUSR1, old_); }
  CountSignals(const CountSignals&) = delete;
  CountSignals& operator=(const CountSignals&) = delete;
  /// Others may count requests too.
  static std::atomic<int>& count() { return count_; }

 private:
  static void add(int) { ++count_; }
  // A signal handler reaches nothing but what is static.
  static inline std::atomic<int> count_ = 0;
  static_assert(std::atomic<int>::is_always_lock_free);
  void (*old_)(int);
};

}  // namespace mixrig::tools
