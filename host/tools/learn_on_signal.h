// SPDX-License-Identifier: Apache-2.0
// Makes SIGUSR1 an order to a run.
#pragma once

#include <atomic>
#include <csignal>

#include "host/output/sink/run_orders.h"

namespace mixrig::tools {

/// While the object exists, SIGUSR1 gives the order output::LearnChanges. The destructor restores
/// the old handler. One object at a time; the orders outlive it.
class LearnOnSignal {
 public:
  explicit LearnOnSignal(output::RunOrders& orders) {
    orders_ = &orders;
    old_ = std::signal(SIGUSR1, learn);
  }
  ~LearnOnSignal() { std::signal(SIGUSR1, old_); }
  LearnOnSignal(const LearnOnSignal&) = delete;
  LearnOnSignal& operator=(const LearnOnSignal&) = delete;

 private:
  static void learn(int) { orders_.load()->learn_by_signal(); }
  // A signal handler can only use static data.
  static inline std::atomic<output::RunOrders*> orders_ = nullptr;
  static_assert(std::atomic<output::RunOrders*>::is_always_lock_free);
  void (*old_)(int);
};

}  // namespace mixrig::tools
