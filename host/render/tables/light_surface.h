// SPDX-License-Identifier: Apache-2.0
// The learned room as a surface for lighting: planes where it is flat within the noise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/render/contract/passes.h"
#include "host/render/tables/depth_planes.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

/// A depth picture with normals and planes; all images have its size.
struct LightSurface {
  Image<float> depth_m;        ///< z; 0 unknown
  Image<PackedNormal> normal;  ///< in camera axes, towards the camera; 0 unknown
  Image<std::uint8_t> plane;   ///< index in `planes`; kNoPlane: the depth as learned, or unknown
  std::vector<WPlane> planes;  ///< in camera axes, at most kMostPlanes
};
inline constexpr std::uint8_t kNoPlane = 255;

/// Where an object stands: the centre of its contact area and the direction up from there, in
/// camera axes.
struct ObjectFoot {
  Eigen::Vector3d at_m{0, 0, 0}, up{0, 0, 1};
};

/// Replaces depths by a plane where a region is flat within the noise of one measurement; unknown
/// pixels take a plane that most directions around meet. Other depths stay as they are, with
/// normals over the smallest window of 1, 2, 4 or 8 `footprint_px` at which the noise turns them by
/// less than 0.1 rad. The plane nearest to one of `feet`, across its up direction and within 5 % of
/// the depth, is scaled in depth to go through it. Pure; time grows with the pixels.
LightSurface light_surface(ImageView<const float> depth_m, const geometry::Pinhole& view,
                           const NoiseParams& noise, int footprint_px,
                           std::span<const ObjectFoot> feet = {});

/// Feet of the objects outside the set, from their own boxes. `camera_from_world`: pose at which
/// the background was learned. Pure.
std::vector<ObjectFoot> feet_of(std::span<const VirtualObject> objects,
                                const geometry::Pose& camera_from_world);

}  // namespace mixrig::render
