// SPDX-License-Identifier: Apache-2.0
// Covariance of a pose from its patches. Private to this module.
#pragma once

#include <span>

#include "host/pose/tracker/patch_align.h"

namespace mixrig::tracking {

/// Returns the covariance of (rotation vector rad, translation m) of camera_from_room, R = exp(w) *
/// R_estimate; the normal equations must have full rank. Each patch has an independent error, by
/// its information and the residual offsets; `scale` (in sigmas) is used if there are too few
/// patches to estimate that. Patches in the same of 24 directions of the room also share errors, a
/// small rotation and a stretch of that part of the room, since views of a sweep do not agree
/// exactly. The size of these errors is estimated from the offsets that remain after the fit
/// (random effects by moments: DerSimonian and Laird 1986).
Eigen::Matrix<double, 6, 6> pose_covariance(std::span<const PatchAlign::Seen> seen,
                                            const geometry::Pose& camera_from_room, double scale);

}  // namespace mixrig::tracking
