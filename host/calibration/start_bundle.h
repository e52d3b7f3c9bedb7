// SPDX-License-Identifier: Apache-2.0
// Where a bundle starts from. Private to this room.
#pragma once

#include <vector>

#include "host/calibration/bundle.h"

namespace mixrig::calibration {

/// Pose of a board from the rays of its points (homogeneous DLT, then the nearest rotation), with
/// its root mean square distance in px; nullopt where the points carry none.
std::optional<PoseVector> pose_from_rays(const geometry::AnyCamera& camera, const BundleView& view);

/// A camera without distortion, its centre in the middle of the picture, of the focal length that
/// suits most views, and the poses that go with it. False where no focal length gives poses.
bool start(Bundle& bundle, Size size_px);

}  // namespace mixrig::calibration
