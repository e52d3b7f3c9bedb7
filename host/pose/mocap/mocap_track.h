// SPDX-License-Identifier: Apache-2.0
// The camera's pose at any recent time, from the frames of a motion capture as they come.
#pragma once

#include <mutex>
#include <optional>

#include "hal/base/clock.h"
#include "host/capture/capture/pose_source.h"
#include "host/pose/mocap/constellation_file.h"
#include "host/pose/mocap/natnet_receiver.h"
#include "host/pose/mocap/track.h"
#include "host/pose/source/pose_track.h"

namespace mixrig::pose {

struct MocapOptions {
  std::optional<mocap::Constellation> constellation;  ///< absent: bodies as the stream has them
  int body_id = 0;                                    ///< of a body; 0: the only one
  mocap::Up up = mocap::Up::kY;
  Mount mount;                ///< of the external calibration
  double delay_s = 0;         ///< from the exposure of a frame to its earliest arrival
  double most_ahead_s = 0.1;  ///< the motion is continued this far after the newest frame
};

/// The target camera in one frame of a motion capture, in a world with z up; covariance of markers
/// and external calibration. nullopt where the body is not in the frame, not tracked, or not the
/// only one.
std::optional<TargetSeen> target_seen(const stream::NatNetFrame& frame,
                                      const MocapOptions& options);

/// PoseTrack of a motion capture. Thread-safe.
class MocapTrack {
 public:
  explicit MocapTrack(MocapOptions options)
      : options_(std::move(options)), track_({options_.delay_s, options_.most_ahead_s}) {}

  /// A frame, and when it came.
  void add(const stream::NatNetFrame& frame, HostTime received);
  /// The counts of the receiver.
  void set_packets(const stream::NatNetCounts& counts);
  capture::CameraPose at(HostTime mid_exposure) const { return track_.at(mid_exposure); }
  capture::PoseFaults faults() const;
  capture::PoseStream stream() const;

 private:
  const MocapOptions options_;
  PoseTrack track_;
  mutable std::mutex mutex_;  ///< guards what follows
  stream::NatNetCounts counts_;
};

}  // namespace mixrig::pose
