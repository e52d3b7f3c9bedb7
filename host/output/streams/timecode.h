// SPDX-License-Identifier: Apache-2.0
// Timecode of a stream's pictures as SMPTE ST 12-1 counts it, without drop-frame numbering.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "hal/base/clock.h"
#include "hal/base/clock_sync.h"

namespace mixrig::output {

struct Timecode {
  unsigned hours = 0, minutes = 0, seconds = 0, frames = 0;
  friend bool operator==(const Timecode&, const Timecode&) = default;
};

/// Timecode of the n-th picture of a day at `per_second` pictures a second; wraps after 24 hours.
/// Precondition: per_second >= 1.
Timecode timecode_of(std::int64_t number, unsigned per_second);

/// Returns the time of day at host time 0 for a picture that is exposed at `now`.
using DayAtZero = std::function<Duration(HostTime now)>;

/// Numbers pictures by their mid-exposures: lost pictures leave a gap, and jitter below half a
/// period has no effect. Where the time of day at host time 0 changes, the next picture has the new
/// time. Not thread-safe.
class TimecodeCounter {
 public:
  /// `day_at_zero`: null: the first picture is 00:00:00:00. Precondition: rate_hz >= 0.5.
  TimecodeCounter(double rate_hz, DayAtZero day_at_zero);
  Timecode next(HostTime mid_exposure);
  /// Picture numbers a second: the rate, rounded.
  unsigned per_second() const { return per_second_; }

 private:
  const double rate_hz_;
  const unsigned per_second_;
  const DayAtZero day_at_zero_;
  Duration day_{};  ///< what day_at_zero_ has returned
  std::optional<HostTime> first_;
  std::int64_t first_number_ = 0;
};

/// Local time of day at host time 0, in the time zone that is in force at `now`. `epoch_ns`: Unix
/// time of host time 0, nanoseconds.
Duration local_day_at_zero(std::int64_t epoch_ns, HostTime now);

/// local_day_at_zero() by a system time that may be set while a run goes on.
DayAtZero local_day_by(EpochReader epoch);

}  // namespace mixrig::output
