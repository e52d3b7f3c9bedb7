// SPDX-License-Identifier: Apache-2.0
// Time types that cannot be mixed, and the clock interface.
#pragma once

#include <chrono>
#include <cstdint>

namespace mixrig {

using Duration = std::chrono::nanoseconds;

/// A clock domain: time points of different tags do not compare, add or convert.
template <typename Tag>
struct ClockDomain {
  using duration = Duration;
  using rep = Duration::rep;
  using period = Duration::period;
  using time_point = std::chrono::time_point<ClockDomain, Duration>;
  static constexpr bool is_steady = true;
};

using HostTime = ClockDomain<struct HostTag>::time_point;      ///< CLOCK_MONOTONIC of this host
using McuTime = ClockDomain<struct McuTag>::time_point;        ///< the trigger controller's clock
using DeviceTime = ClockDomain<struct DeviceTag>::time_point;  ///< one camera's own clock

inline double seconds(Duration d) { return std::chrono::duration<double>(d).count(); }
inline double milliseconds(Duration d) { return seconds(d) * 1e3; }

/// Source of host time. Passed in everywhere, so that tests can control time. Thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual HostTime now() const = 0;
  /// Returns at or after `until`.
  virtual void sleep_until(HostTime until) = 0;
};

/// CLOCK_MONOTONIC.
class SystemClock final : public Clock {
 public:
  HostTime now() const override {
    return HostTime(
        std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
  }
  void sleep_until(HostTime until) override;
};

/// A clock that stands still until advance() or sleep_until() moves it.
class ManualClock final : public Clock {
 public:
  HostTime now() const override { return now_; }
  void sleep_until(HostTime until) override { now_ = until > now_ ? until : now_; }
  void advance(Duration by) { now_ += by; }

 private:
  HostTime now_{};
};

}  // namespace mixrig
