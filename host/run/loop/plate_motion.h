// SPDX-License-Identifier: Apache-2.0
// Estimates the camera's motion during each plate's exposure from the poses of frames.
#pragma once

#include <optional>

#include "host/capture/capture/pose_source.h"
#include "host/render/contract/compositor.h"

namespace mixrig::session {

/// For one thread; nothing allocates.
class PlateMotion {
 public:
  /// Largest gap between frames; beyond it motion is unknown.
  static constexpr double kMostGap_s = 0.25;

  /// `exposure_s`: of a plate; 0: unknown, then motion is unknown too.
  explicit PlateMotion(double exposure_s = 0) : exposure_s_(exposure_s) {}

  /// Motion during the next frame, in order: from the last two steps between poses with constant
  /// acceleration, or from the only step. Nullopt without a pose or a step.
  std::optional<render::CameraMotion> next(const capture::CameraPose& pose, double time_s);

 private:
  struct Rate {  ///< mean rate over a step, per second
    Eigen::Vector3d turn_rad, shift_m;
    double step_s = 0;
  };
  std::optional<Rate> step_to(const geometry::Pose& world_from_target, double time_s) const;

  double exposure_s_, last_s_ = 0;
  std::optional<geometry::Pose> last_;
  std::optional<Rate> last_rate_;
};

}  // namespace mixrig::session
