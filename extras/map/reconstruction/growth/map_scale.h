// SPDX-License-Identifier: Apache-2.0
// The scale of a map from a depth camera of the same rig.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "extras/map/reconstruction/maps/learned_map.h"
#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"

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

/// What a depth camera saw beside the pictures.
struct DepthRecord {
  std::vector<DepthView> views;
  DepthCamera camera;
};

/// A place in axes of the map, and the times of the pictures that show it, ascending.
struct SeenPlace {
  Eigen::Vector3d place;
  std::vector<double> seen_s;
};

struct ScaleFit {
  double metres_per_unit = 0;
  MapScale scale;
  /// By each place alone; 0 where the depth camera does not show it, or shows something else.
  std::vector<double> of_place;
};

/// Each place that a depth picture shows on a smooth surface, while a picture within 0.1 s shows it
/// too (else someone may stand before it), gives a ratio at the pose of the path at that time.
/// Of each place the median counts, of all places the mode: what the depth camera sees instead, and
/// edges, lie on one side. It is found by the shortest interval with half of the places, then the
/// mean within 2.5 of their deviations. The sigma is that of the mean; errors that all depth values
/// share are not in it. nullopt for fewer than 30 places, or a sigma above 5 %.
std::optional<ScaleFit> scale_by_depth(std::span<const SeenPlace> places,
                                       const trajectory::Trajectory& path,
                                       const DepthRecord& depth);

}  // namespace mixrig::reconstruction
