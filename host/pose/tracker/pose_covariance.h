// SPDX-License-Identifier: Apache-2.0
// How well patches tell a pose. Private to this module.
#pragma once

#include <span>

#include "host/pose/tracker/patch_align.h"

namespace mixrig::tracking {

/// Of (rotation vector rad, translation m) of camera_from_room, R = exp(w) * R_estimate; the normal
/// equations must have full rank. Each patch errs on its own, by its information and what is left
/// of the offsets; `scale` (in sigmas) where too few patches tell that. Patches in the same of 24
/// directions of the room also err together, by a small turn of that part of the room: views of a
/// sweep do not agree exactly. The size of the turns follows from the offsets that are left after
/// the fit (random effects by moments: DerSimonian and Laird 1986).
Eigen::Matrix<double, 6, 6> pose_covariance(std::span<const PatchAlign::Seen> seen,
                                            const geometry::Pose& camera_from_room, double scale);

}  // namespace mixrig::tracking
