// SPDX-License-Identifier: Apache-2.0
// The pan-tilt head of a source that renders its frames for the head's angles.
#pragma once

#include <memory>
#include <mutex>

#include "hal/base/clock.h"
#include "hal/device/pan_tilt.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::live {

/// The motion of a head that is moved by commands: both axes at one constant speed, to whole steps.
/// After it stops the pan axis swings for some tenths of a second, which its encoder does not see.
/// The last two commands are kept, so that the time of a picture may lie before the newest one.
/// Thread-safe. Nothing allocates.
class SteeredMotion {
 public:
  explicit SteeredMotion(device::PanTiltInfo info) : info_(std::move(info)) {}

  const device::PanTiltInfo& info() const { return info_; }
  /// Starts a move. Errors: kUsage beyond the limits; then nothing moves.
  Result<void> move_to(device::PanTiltAngles target, HostTime now);
  void halt(HostTime now);
  /// Sets the speed of later commands. Precondition: above 0.
  void set_speed(double rad_s);
  capture::HeadMotion at(HostTime time) const;

 private:
  struct Move {
    HostTime begin{};
    device::PanTiltAngles from, to;
    double speed_rad_s = 1;
  };
  static capture::HeadMotion during(const Move& move, HostTime time);
  capture::HeadMotion now_at(HostTime time) const;

  const device::PanTiltInfo info_;
  mutable std::mutex mutex_;  ///< guards the members below
  double speed_rad_s_ = 1.75;
  Move before_, newest_;
};

/// Makes the head. It answers at most a hundred times a second, with angles in whole steps.
std::unique_ptr<device::PanTilt> make_steered_head(std::shared_ptr<SteeredMotion> motion,
                                                   Clock& clock);

}  // namespace mixrig::live
