// SPDX-License-Identifier: Apache-2.0
// A picture as another place of the camera would see it.
#pragma once

#include "studio/sensors/lens.h"

namespace mixrig::studio {

/// Pixel in the picture of `mid` of the point that the camera at `then` sees at `px`, `z_m` before
/// it.
Eigen::Vector2f seen_from(const RayGrid& rays, const Optics& optics,
                          const geometry::Pose& mid_from_then, const Eigen::Vector2f& px,
                          float z_m);
/// Bilinear value of a picture, whose border pixels continue beyond it.
Rgbf sample(const Image<Rgbf>& picture, const Eigen::Vector2f& px);

}  // namespace mixrig::studio
