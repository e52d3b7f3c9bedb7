// SPDX-License-Identifier: Apache-2.0
// The start of a bundle adjustment. Private to this module.
#pragma once

#include <vector>

#include "host/calibrate/intrinsics/bundle.h"

namespace mixrig::calibration {

/// Pose of a board from the rays of its points (homogeneous DLT, then the nearest rotation), with
/// its root mean square distance in px; nullopt where the points do not determine it.
std::optional<PoseVector> pose_from_rays(const geometry::AnyCamera& camera, const BundleView& view);

/// Fills `bundle` with a camera without distortion, its centre in the middle of the picture and the
/// focal length of the least median error over the views, and with the views' poses for it. False
/// where no focal length gives poses.
bool start(Bundle& bundle, Size size_px);

}  // namespace mixrig::calibration
