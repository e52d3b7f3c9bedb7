// SPDX-License-Identifier: Apache-2.0
// Finds the pose of a camera on a moving hand from poses of both (hand-eye calibration).
#pragma once

#include <span>

#include "host/math/estimation/verdict.h"
#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

/// world_from_hand * hand_from_eye * eye_from_target = world_from_target for every view.
struct HandEye {
  geometry::Pose hand_from_eye;
  geometry::Pose world_from_target;
};

/// Noise of eye_from_target (and of world_from_hand, seen at the target), both > 0.
struct HandEyeOptions {
  double sigma_rad = 1e-3;
  double sigma_m = 1e-3;
};

/// Solves the rotation from corresponding rotation axes (Park and Martin 1994), then the
/// translation linearly, then all twelve parameters by least squares. Covariance 12x12:
/// pose_error() of hand_from_eye, then of world_from_target. Residuals: length of the whitened
/// error per view, in sigmas.
/// Degenerate: fewer than 3 views, no rotation, all rotation axes parallel, contradicting views.
Estimate<HandEye> solve_hand_eye(std::span<const geometry::Pose> world_from_hand,
                                 std::span<const geometry::Pose> eye_from_target,
                                 const HandEyeOptions& options = {});

}  // namespace mixrig::estimation
