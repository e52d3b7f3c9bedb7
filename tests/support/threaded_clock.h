// SPDX-License-Identifier: Apache-2.0
// Injected time for several threads.
#pragma once

#include <atomic>
#include <thread>

#include "hal/base/clock.h"

namespace mixrig::test {

/// Moves when told; who sleeps moves it as well, so that drivers that wait between tries cost no
/// real time. Any threads.
class ThreadedClock : public Clock {
 public:
  HostTime now() const override { return HostTime(Duration(now_ns_.load())); }
  void sleep_until(HostTime until) override {
    const std::int64_t wanted_ns = until.time_since_epoch().count();
    std::int64_t now_ns = now_ns_;
    while (now_ns < wanted_ns && !now_ns_.compare_exchange_weak(now_ns, wanted_ns)) {
    }
    std::this_thread::yield();
  }
  void advance(Duration by) { now_ns_ += by.count(); }

 private:
  std::atomic<std::int64_t> now_ns_{1'000'000'000};
};

/// The same, but only advance() moves it: sleep_until gives up the processor and returns too early,
/// so that who sleeps in a loop waits for the test.
class SteppedClock final : public ThreadedClock {
 public:
  void sleep_until(HostTime) override { std::this_thread::yield(); }
};

}  // namespace mixrig::test
