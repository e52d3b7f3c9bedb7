// SPDX-License-Identifier: Apache-2.0
// The scale of a map from a depth camera of the same rig.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "hal/base/image.h"
#include "host/geometry/camera_model.h"
#include "host/reconstruction/learned_map.h"

namespace mixrig::reconstruction {

/// A picture of the depth camera.
struct DepthView {
  double time_s = 0;
  Image<float> depth_m;  ///< z, or distance where `is_distance`; 0 unknown
};

struct DepthCamera {
  geometry::CameraModel model;
  geometry::Pose from_camera;  ///< depth camera from the camera of the map
  bool is_distance = false;
};

struct ScaleFit {
  double metres_per_unit = 0;
  MapScale scale;
};

/// Each point of the map that a depth picture shows on a smooth surface gives a ratio, at the pose
/// that the path has at its time; the result is their median, first of each point and then of all
/// points. Its sigma is that of the median over the points, by their median deviation; errors that
/// all depth values share are not in it. nullopt for fewer than 30 points, or a sigma above 5 %.
std::optional<ScaleFit> scale_by_depth(const LearnedMap& map, std::span<const DepthView> views,
                                       const DepthCamera& camera);

}  // namespace mixrig::reconstruction
