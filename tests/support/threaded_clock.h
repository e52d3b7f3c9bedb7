// SPDX-License-Identifier: Apache-2.0
// A simulated clock for several threads.
#pragma once

#include <atomic>
#include <thread>

#include "hal/base/clock.h"

namespace mixrig::test {

/// Only advance() and sleep_until() advance it, so that drivers that wait between attempts take no
/// real time. Thread-safe.
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

/// Only advance() advances it. sleep_until() yields and returns too early, so that a loop that
/// sleeps until a time waits for the test.
class SteppedClock final : public ThreadedClock {
 public:
  void sleep_until(HostTime) override { std::this_thread::yield(); }
};

}  // namespace mixrig::test
