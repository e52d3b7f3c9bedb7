// SPDX-License-Identifier: Apache-2.0
// Smooths a pose with poses before and after it.
#pragma once

#include <cstddef>
#include <span>

#include "host/capture/capture/pose_source.h"
#include "host/math/geometry/pose.h"

namespace mixrig::pose {

/// A pose measured at a time; the covariance is in axes of the room.
struct MeasuredPose {
  double time_s = 0;
  geometry::Pose room_from_body;
  capture::PoseCovariance covariance = capture::PoseCovariance::Zero();
};

inline constexpr std::size_t kMostSmoothed = 32;

/// Returns the pose at `time_s`. Each coordinate of the rotation vector and the position about the
/// nearest pose is a smoothing spline (Wahba 1990) through those of `around`, weighted by their
/// variances. The motion's jerk is white noise; results for four strengths of it, from standstill
/// to a jolt, are averaged by their likelihood, so that a sudden motion is followed and a steady
/// one smoothed. Poses on both sides give a result without lag. Precondition: 1 to kMostSmoothed
/// poses, their times grow. The covariance is that of the nearest pose, and at least the spline's
/// variances, since errors that the poses have in common do not average out. Does not allocate.
MeasuredPose smooth_at(std::span<const MeasuredPose> around, double time_s);

}  // namespace mixrig::pose
