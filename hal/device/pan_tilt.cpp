// SPDX-License-Identifier: Apache-2.0
#include "hal/device/pan_tilt.h"

#include <cmath>

#include <fmt/format.h>

namespace mixrig::device {

Result<void> await_position(PanTilt& head, PanTiltAngles target, Clock& clock, Duration timeout) {
  constexpr Duration kPoll = std::chrono::milliseconds(20);
  const HostTime end = clock.now() + timeout;
  const PanTiltAngles step = head.info().resolution;
  while (true) {
    MIXRIG_ASSIGN(const PanTiltSample sample, head.sample());
    const double pan_off_rad = sample.angles.pan_rad - target.pan_rad;
    const double tilt_off_rad = sample.angles.tilt_rad - target.tilt_rad;
    if (std::abs(pan_off_rad) <= 0.51 * step.pan_rad &&
        std::abs(tilt_off_rad) <= 0.51 * step.tilt_rad)
      return {};
    if (clock.now() >= end)
      return Error{ErrorCode::kTimeout,
                   fmt::format("pan-tilt unit is {:.4f} rad (pan) and {:.4f} rad (tilt) off after "
                               "{:.1f} s: check limits, load and power",
                               pan_off_rad, tilt_off_rad, seconds(timeout))};
    clock.sleep_until(clock.now() + kPoll);
  }
}

}  // namespace mixrig::device
