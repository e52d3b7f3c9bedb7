// SPDX-License-Identifier: Apache-2.0
// The pan-tilt head of a recording that is played.
#pragma once

#include <memory>
#include <mutex>

#include "hal/base/clock.h"
#include "hal/device/pan_tilt.h"

namespace mixrig::live {

/// The angles of the frames that were read last, each at the time when its frame is due.
/// Thread-safe. Nothing allocates.
class PlayedAngles {
 public:
  explicit PlayedAngles(device::PanTiltAngles first) : first_(first) {}
  /// It plays from the first frame again.
  void restart();
  /// The angles of the next frame; times increase.
  void add(HostTime at, device::PanTiltAngles angles);
  /// No more frames: the head stands still at the last angles.
  void end();
  /// Linear between two frames, with the time `now`. Before the first frame its angles. After the
  /// newest frame that was read: its angles with its time, as if the head had not answered since.
  device::PanTiltSample at(HostTime now) const;

 private:
  struct Point {
    HostTime at{};
    device::PanTiltAngles angles;
  };
  const device::PanTiltAngles first_;
  mutable std::mutex mutex_;  ///< guards what follows
  Point before_, newest_;
  int count_ = 0;
  bool ended_ = false;
};

/// A head that moves as in the recording and by nothing else: move_to, set_motion and halt give
/// kUnsupported. Asked in a loop it answers a hundred times a second.
std::unique_ptr<device::PanTilt> make_played_head(std::shared_ptr<const PlayedAngles> angles,
                                                  device::PanTiltInfo info, Clock& clock);

}  // namespace mixrig::live
