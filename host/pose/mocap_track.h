// SPDX-License-Identifier: Apache-2.0
// The camera's pose at any recent time, from the frames of a motion capture as they come.
#pragma once

#include <array>
#include <mutex>
#include <optional>

#include "hal/base/clock.h"
#include "host/calibration_file/calibration.h"
#include "host/capture/pose_source.h"
#include "host/mocap/constellation_file.h"
#include "host/mocap/track.h"
#include "host/pose/motion_check.h"
#include "host/stream/natnet_receiver.h"
#include "host/sync/device_clock.h"

namespace mixrig::pose {

struct MocapOptions {
  std::optional<mocap::Constellation> constellation;  ///< absent: bodies as the stream has them
  int body_id = 0;                                    ///< of a body; 0: the only one
  mocap::Up up = mocap::Up::kY;
  geometry::Pose body_from_target;                         ///< of the external calibration
  std::optional<capture::PoseCovariance> body_covariance;  ///< of body_from_target
  double delay_s = 0;         ///< from the exposure of a frame to its earliest arrival
  double most_ahead_s = 0.1;  ///< the motion is continued this far after the newest frame
};

/// Sets the body's pose and its covariance from the entry `body` of a calibration.
void set_body(MocapOptions& options, const calibration_file::CalibratedPose& body);

/// The target camera in one frame of a motion capture.
struct TargetSeen {
  geometry::Pose world_from_target;                   ///< z up
  std::optional<capture::PoseCovariance> covariance;  ///< of markers and external calibration
};
/// nullopt where the body is not in the frame, not tracked, or not the only one.
std::optional<TargetSeen> target_seen(const stream::NatNetFrame& frame,
                                      const MocapOptions& options);

/// The last half second and more of a stream. Its clock is mapped to the host's by the least delay
/// (sync::DeviceClock), of which `delay_s` is the constant part. Thread-safe.
class MocapTrack {
 public:
  explicit MocapTrack(MocapOptions options) : options_(std::move(options)) {}

  /// A frame, and when it came.
  void add(const stream::NatNetFrame& frame, HostTime received);
  /// The counts of the receiver.
  void set_packets(const stream::NatNetCounts& counts);

  /// Between two frames interpolated; after the newest one the motion of the last kMotion_s goes on
  /// for most_ahead_s. Covariance: that of the nearest frame, grown by the prediction from two
  /// noisy poses. Does not allocate.
  capture::CameraPose at(HostTime mid_exposure) const;
  capture::PoseFaults faults() const;
  capture::PoseStream stream() const;

  static constexpr double kMotion_s = 0.03;
  static constexpr double kGap_s = 0.05;  ///< frames farther apart have nothing between them

 private:
  static constexpr std::size_t kKept = 256;
  struct Sample {
    trajectory::TimedPose timed;  ///< t_s: the stream's clock
    std::optional<capture::PoseCovariance> covariance;
  };
  void restart();
  void keep(const Sample& sample);
  /// The i-th newest.
  const Sample& newest(std::size_t i) const { return kept_[(end_ + kKept - 1 - i) % kKept]; }
  std::optional<double> stream_time_s(HostTime at) const;
  capture::CameraPose ahead(double t_s) const;

  const MocapOptions options_;
  mutable std::mutex mutex_;  ///< guards what follows
  sync::DeviceClock clock_;
  MotionCheck check_;
  std::array<Sample, kKept> kept_{};
  std::size_t end_ = 0, count_ = 0;
  std::uint64_t packets_ = 0;
  capture::PoseFaults faults_;  ///< without those of check_
};

}  // namespace mixrig::pose
