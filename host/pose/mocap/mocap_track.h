// SPDX-License-Identifier: Apache-2.0
// The camera's pose at any recent time, from the frames of a running motion capture.
#pragma once

#include <array>
#include <cstdint>
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
  std::optional<mocap::Constellation> constellation;  ///< absent: use the bodies of the stream
  int body_id = 0;                                    ///< id of the body; 0: the only one
  mocap::Up up = mocap::Up::kY;
  Mount mount;                ///< from the external calibration
  double delay_s = 0;         ///< from the exposure of a frame to its earliest arrival
  double most_ahead_s = 0.1;  ///< the motion is continued this far after the newest frame
};

/// Returns the target camera in one frame of a motion capture, in a world with z up; its covariance
/// is that of markers and external calibration. nullopt if the body is not in the frame, not
/// tracked, or not the only one.
std::optional<TargetSeen> target_seen(const stream::NatNetFrame& frame,
                                      const MocapOptions& options);

/// Why a frame has no usable body, where its bodies are used.
enum class BodyTrouble : std::uint8_t { kNone, kNoBody, kSeveral, kAnother };
BodyTrouble body_trouble(const stream::NatNetFrame& frame, const MocapOptions& options);

/// A PoseTrack of a motion capture. Warns once of each BodyTrouble. Thread-safe.
class MocapTrack {
 public:
  explicit MocapTrack(MocapOptions options)
      : options_(std::move(options)), track_({options_.delay_s, options_.most_ahead_s}) {}

  /// Adds a frame and its time of arrival.
  void add(const stream::NatNetFrame& frame, HostTime received);
  /// Sets the counts of the receiver.
  void set_packets(const stream::NatNetCounts& counts);
  capture::CameraPose at(HostTime mid_exposure) const { return track_.at(mid_exposure); }
  capture::PoseFaults faults() const;
  capture::PoseStream stream() const;

 private:
  const MocapOptions options_;
  PoseTrack track_;
  mutable std::mutex mutex_;  ///< guards the members below
  stream::NatNetCounts counts_;
  std::array<bool, 4> warned_{};  ///< by BodyTrouble
};

}  // namespace mixrig::pose
