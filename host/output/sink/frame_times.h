// SPDX-License-Identifier: Apache-2.0
// Increasing times of frames, even for a take that does not record times.
#pragma once

#include <optional>

namespace mixrig::session {

class FrameTimes {
 public:
  static constexpr double kAssumedRate_hz = 25;  ///< for a take without times
  /// A time later than all before, from the time of the next capture.
  double next(double capture_s) {
    if (last_s_ && capture_s <= *last_s_) shift_s_ += 1 / kAssumedRate_hz;
    last_s_ = capture_s;
    return capture_s + shift_s_;
  }

 private:
  std::optional<double> last_s_;  ///< of the last capture, as given
  double shift_s_ = 0;
};

}  // namespace mixrig::session
