// SPDX-License-Identifier: Apache-2.0
// Finds the scale of a map by a depth camera of the same rig.
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
  geometry::Pose from_camera;  ///< pose of the map's camera in the depth camera
  bool is_distance = false;
};

/// Depth pictures that were recorded with the colour pictures.
struct DepthRecord {
  std::vector<DepthView> views;
  DepthCamera camera;
};

/// A point in axes of the map, and the times of the pictures that show it, ascending.
struct SeenPlace {
  Eigen::Vector3d place;
  std::vector<double> seen_s;
};

struct ScaleFit {
  double metres_per_unit = 0;
  MapScale scale;
  /// Metres per unit by each point alone; 0 where the depth camera does not show it, or shows
  /// something else.
  std::vector<double> of_place;
};

/// Estimates the scale. A point gives a ratio where a depth picture shows it on a smooth surface,
/// at the pose of the path at that time, while a picture within 0.1 s also shows it (else someone
/// may stand before it). The median counts for each point, the mode over all points, since wrong
/// surfaces and edges err to one side. The mode is found by the shortest interval with half of the
/// points, then the mean within 2.5 of their deviations. The sigma is that of the mean; it does not
/// include errors that all depth values share. nullopt for fewer than 30 points, or a sigma above 5
/// %.
std::optional<ScaleFit> scale_by_depth(std::span<const SeenPlace> places,
                                       const trajectory::Trajectory& path,
                                       const DepthRecord& depth);

}  // namespace mixrig::reconstruction
