// SPDX-License-Identifier: Apache-2.0
// Measures how often something happens.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "hal/base/clock.h"

namespace mixrig::viewfinder {

/// Rate of events over the last second; remembers at most 128 events.
class RateMeter {
 public:
  void add(HostTime at) { times_[count_++ % times_.size()] = at; }
  /// Events a second, from those at most one second before `now`; 0 for less than two.
  double rate_hz(HostTime now) const {
    if (count_ == 0) return 0;
    const HostTime newest = at(1);
    HostTime oldest = newest;
    std::size_t events = 0;
    while (events < std::min(count_, times_.size()) &&
           now - at(events + 1) <= std::chrono::seconds(1))
      oldest = at(++events);
    return events < 2 ? 0 : static_cast<double>(events - 1) / seconds(newest - oldest);
  }

 private:
  /// The event `back` places from the end; 1 is the newest.
  HostTime at(std::size_t back) const { return times_[(count_ - back) % times_.size()]; }
  std::array<HostTime, 128> times_{};
  std::size_t count_ = 0;
};

}  // namespace mixrig::viewfinder
