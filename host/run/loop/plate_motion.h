// SPDX-License-Identifier: Apache-2.0
// How the camera moved while each plate was exposed, by the poses of the frames.
#pragma once

#include <optional>

#include "host/capture/capture/pose_source.h"
#include "host/render/contract/compositor.h"

namespace mixrig::session {

/// One thread; nothing allocates.
class PlateMotion {
 public:
  static constexpr double kMostGap_s = 0.25;  ///< between frames; after more nothing is known

  /// `exposure_s` of a plate; 0: not known, and then no motion is.
  explicit PlateMotion(double exposure_s = 0) : exposure_s_(exposure_s) {}

  /// Of the next frame, in order: by the last two steps between poses, as if acceleration were
  /// constant, or by the one that there is. None without a pose or a step.
  std::optional<render::CameraMotion> next(const capture::CameraPose& pose, double time_s);

 private:
  struct Rate {  ///< in the middle of a step, per second
    Eigen::Vector3d turn_rad, shift_m;
    double step_s = 0;
  };
  std::optional<Rate> step_to(const geometry::Pose& world_from_target, double time_s) const;

  double exposure_s_, last_s_ = 0;
  std::optional<geometry::Pose> last_;
  std::optional<Rate> last_rate_;
};

}  // namespace mixrig::session
