// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "hal/base/clock.h"
#include "host/render/contract/compositor.h"

namespace mixrig::render::cpu {

/// Adds wall time to stages, from one lap() to the next.
class StopWatch {
 public:
  explicit StopWatch(StageTimes& times) : times_(times) { times_.fill(0); }
  void lap(Stage stage) {
    const HostTime now = clock_.now();
    times_[static_cast<std::size_t>(stage)] += static_cast<float>(milliseconds(now - last_));
    last_ = now;
  }

 private:
  SystemClock clock_;
  StageTimes& times_;
  HostTime last_ = clock_.now();
};

}  // namespace mixrig::render::cpu
