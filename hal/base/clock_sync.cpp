// SPDX-License-Identifier: Apache-2.0
#include "hal/base/clock_sync.h"

#include <cstdlib>

#include <sys/timex.h>

namespace mixrig {

bool host_clock_is_synchronized() {
  timex state{};  // no mode: it is read
  const int clock = ::adjtimex(&state);
  return clock >= 0 && clock != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

std::int64_t HeldEpoch::at(HostTime now) {
  constexpr Duration kReadEvery = std::chrono::seconds(1);
  if (read_at_ && now < *read_at_ + kReadEvery && now >= *read_at_) return held_ns_;
  const std::int64_t fresh_ns = read_();
  if (!read_at_ || std::abs(fresh_ns - held_ns_) >= kLeastStep.count()) held_ns_ = fresh_ns;
  read_at_ = now;
  return held_ns_;
}

Duration tai_minus_utc() {
  constexpr int kSince2017_s = 37;
  timex state{};
  const bool known = ::adjtimex(&state) >= 0 && state.tai > 0;
  return std::chrono::seconds(known ? state.tai : kSince2017_s);
}

}  // namespace mixrig
