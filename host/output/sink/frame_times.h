// SPDX-License-Identifier: Apache-2.0
// Times of frames, also of a take that does not know them.
#pragma once

#include <optional>

namespace mixrig::session {

class FrameTimes {
 public:
  static constexpr double kAssumedRate_hz = 25;  ///< of a take that does not know its times
  /// A time later than those before, from that of the next capture.
  double next(double capture_s) {
    if (last_s_ && capture_s <= *last_s_) shift_s_ += 1 / kAssumedRate_hz;
    last_s_ = capture_s;
    return capture_s + shift_s_;
  }

 private:
  std::optional<double> last_s_;  ///< of a capture, as it says
  double shift_s_ = 0;
};

}  // namespace mixrig::session
