// SPDX-License-Identifier: Apache-2.0
// The pan-tilt head of a recording that is played.
#pragma once

#include <memory>
#include <mutex>

#include "hal/base/clock.h"
#include "hal/device/pan_tilt.h"

namespace mixrig::live {

/// Angles of the frames that were read last, each at the time when its frame is due. Thread-safe.
/// Nothing allocates.
class PlayedAngles {
 public:
  explicit PlayedAngles(device::PanTiltAngles first) : first_(first) {}
  /// Starts again from the first frame.
  void restart();
  /// Adds the angles of the next frame; times increase.
  void add(HostTime at, device::PanTiltAngles angles);
  /// Ends the recording: the head stands still at the last angles.
  void end();
  /// Interpolates linearly between two frames, stamped `now`. Before the first frame it returns
  /// that frame's angles. After the newest frame it returns that frame's angles and time, as if the
  /// head had not answered since.
  device::PanTiltSample at(HostTime now) const;

 private:
  struct Point {
    HostTime at{};
    device::PanTiltAngles angles;
  };
  const device::PanTiltAngles first_;
  mutable std::mutex mutex_;  ///< guards the members below
  Point before_, newest_;
  int count_ = 0;
  bool ended_ = false;
};

/// Makes a head that only moves as in the recording: move_to, set_motion and halt give
/// kUnsupported. It answers at most a hundred times a second.
std::unique_ptr<device::PanTilt> make_played_head(std::shared_ptr<const PlayedAngles> angles,
                                                  device::PanTiltInfo info, Clock& clock);

}  // namespace mixrig::live
