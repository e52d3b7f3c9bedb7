// SPDX-License-Identifier: Apache-2.0
// The learned room as light falls on it: smooth where the room is smooth.
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

/// Images of the size of the depth picture.
struct LightSurface {
  Image<float> depth_m;        ///< z; 0 unknown
  Image<PackedNormal> normal;  ///< axes of the camera, towards it; 0 unknown
  Image<std::uint8_t> plane;   ///< which of `planes`; kNoPlane: the depth as it is, or unknown
  std::vector<WPlane> planes;  ///< axes of the camera, at most kMostPlanes
};
inline constexpr std::uint8_t kNoPlane = 255;

/// Where an object stands, if it does: the middle of its foot and the way up from there, camera
/// axes.
struct ObjectFoot {
  Eigen::Vector3d at_m{0, 0, 0}, up{0, 0, 1};
};

/// Where the depths of a region are a plane within the noise of one measurement, the plane; where
/// nothing is known and most sides meet one plane, that plane goes on. Elsewhere the depth as it
/// is, with normals over the least window of 1, 2, 4 or 8 `footprint_px` at which the noise turns
/// them by less than 0.1 rad. The plane that lies nearest under one of `feet`, at right angles to
/// its way up and within 5 % of the depth, goes through that foot: its depths are as much nearer or
/// farther together. Pure; time grows with the pixels.
LightSurface light_surface(ImageView<const float> depth_m, const geometry::Pinhole& view,
                           const NoiseParams& noise, int footprint_px,
                           std::span<const ObjectFoot> feet = {});

/// Of the objects that are no set, by their own boxes. `camera_from_world`: where the background
/// was learned. Pure.
std::vector<ObjectFoot> feet_of(std::span<const VirtualObject> objects,
                                const geometry::Pose& camera_from_world);

}  // namespace mixrig::render
