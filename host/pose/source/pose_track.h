// SPDX-License-Identifier: Apache-2.0
// The camera's pose at any recent time, from the samples of a running stream.
#pragma once

#include <array>
#include <mutex>
#include <optional>

#include "hal/base/clock.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/capture/capture/pose_source.h"
#include "host/capture/sync/device_clock.h"
#include "host/pose/source/motion_check.h"

namespace mixrig::pose {

/// Pose of the target camera on a tracked body.
struct Mount {
  geometry::Pose body_from_target;
  std::optional<capture::PoseCovariance> covariance;  ///< of body_from_target
};
/// Returns the mount from the entry of a body in a calibration.
Mount mount_of(const calibration_file::CalibratedPose& body);

/// The target camera in one sample of a stream.
struct TargetSeen {
  geometry::Pose world_from_target;
  std::optional<capture::PoseCovariance> covariance;
};
/// Returns the target camera on a body; with a covariance if that of the body is known.
TargetSeen on_body(const geometry::Pose& world_from_body,
                   const std::optional<capture::PoseCovariance>& body_covariance,
                   const Mount& mount);

struct PoseTrackOptions {
  double delay_s = 0;         ///< from the exposure of a sample to its earliest arrival
  double most_ahead_s = 0.1;  ///< the motion is continued this far after the newest sample
  double gap_s = 0.05;        ///< samples farther apart are not interpolated
  bool host_time = false;     ///< samples have host times, and their clock is not mapped
};

/// The last kKept samples of a stream, half a second or more. Its clock is mapped to the host's by
/// the least delay (sync::DeviceClock), whose constant part is `delay_s`. Thread-safe.
class PoseTrack {
 public:
  explicit PoseTrack(PoseTrackOptions options) : options_(options) {}

  /// Adds a sample with its time on the stream's clock and its time of arrival; nullopt if the
  /// camera is not in it.
  void add(double time_s, const std::optional<TargetSeen>& seen, HostTime received);
  /// Returns the pose at a host time, interpolated between two samples. After the newest one the
  /// motion of the last kMotion_s is continued for most_ahead_s. Its covariance is that of the
  /// nearest sample, enlarged by the prediction from two noisy poses. Does not allocate.
  capture::CameraPose at(HostTime mid_exposure) const;
  /// Returns the faults of the samples; `refused` counts those without the camera. Counts of
  /// packets stay 0.
  capture::PoseFaults faults() const;
  /// Returns the state of the stream; the count of packets stays 0.
  capture::PoseStream stream() const;

  static constexpr double kMotion_s = 0.03;

 private:
  static constexpr std::size_t kKept = 256;
  struct Sample {
    trajectory::TimedPose timed;  ///< t_s: the stream's clock
    std::optional<capture::PoseCovariance> covariance;
  };
  void restart();
  void keep(const Sample& sample);
  /// Returns the i-th newest sample.
  const Sample& newest(std::size_t i) const { return kept_[(end_ + kKept - 1 - i) % kKept]; }
  std::optional<double> stream_time_s(HostTime at) const;
  capture::CameraPose ahead(double t_s) const;

  const PoseTrackOptions options_;
  mutable std::mutex mutex_;  ///< guards the members below
  sync::DeviceClock clock_;
  MotionCheck check_;
  std::array<Sample, kKept> kept_{};
  std::size_t end_ = 0, count_ = 0;
  capture::PoseFaults faults_;  ///< without the faults of check_
};

}  // namespace mixrig::pose
