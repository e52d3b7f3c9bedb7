// SPDX-License-Identifier: Apache-2.0
#include "hal/base/clock_sync.h"

#include <sys/timex.h>

namespace mixrig {

bool host_clock_is_synchronized() {
  timex state{};  // no mode: it is read
  const int clock = ::adjtimex(&state);
  return clock >= 0 && clock != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
}

Duration tai_minus_utc() {
  constexpr int kSince2017_s = 37;
  timex state{};
  const bool known = ::adjtimex(&state) >= 0 && state.tai > 0;
  return std::chrono::seconds(known ? state.tai : kSince2017_s);
}

}  // namespace mixrig
