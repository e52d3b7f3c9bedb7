// SPDX-License-Identifier: Apache-2.0
// A map of a room learned from a sequence of pictures: points, their appearance, and the camera's
// path.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "extras/map/reconstruction/features/feature_tracks.h"
#include "hal/base/image.h"
#include "host/math/estimation/points/rigid_fit.h"
#include "host/math/geometry/pose.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::reconstruction {

/// A point of the room in axes and units of the map.
struct MapPoint {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  /// Covariance of `place`, m^2, with the poses of the key frames fixed.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int views = 0;                                 ///< number of key pictures that see it
  int key = 0;                                   ///< key picture that shows its appearance
  Eigen::Vector2d px = Eigen::Vector2d::Zero();  ///< position in that picture
};

/// Appearance of a point in one key picture.
struct MapDescriptor {
  int point = 0;
  Descriptor values{};
};

struct MapKey {
  double time_s = 0;
  geometry::Pose map_from_camera;
  Image<std::uint8_t> grey;
};

/// Scale of a metric map; absent: unknown, and the extent of the path is 1.
struct MapScale {
  double sigma = 0;      ///< relative
  int measurements = 0;  ///< number of distances it comes from
};

/// Accuracy of a map's pose in axes of a scanned room, and the room's pose.
struct RoomAxes {
  double sigma_m = 0, sigma_rad = 0;  ///< of the map's pose, along the worst axis
  std::optional<geometry::Pose> world_from_room;
};

/// A learned map. Its axes are those of the camera at the first key picture that was solved, or of
/// `room`; its unit is the metre where `scale` is set.
struct LearnedMap {
  std::string camera;  ///< camera that took the pictures: "fisheye" or "target"
  std::string calibration_hash;
  std::optional<MapScale> scale;
  std::optional<RoomAxes> room;
  int pictures = 0;        ///< number of pictures processed
  double residual_px = 0;  ///< root mean square of a coordinate in key pictures
  std::vector<MapKey> keys;
  std::vector<MapPoint> points;
  std::vector<MapDescriptor> descriptors;
  std::vector<trajectory::TimedPose> path;  ///< map_from_camera of all pictures with a pose
};

/// Largest distance between two positions of the path.
double extent_of(const std::vector<trajectory::TimedPose>& path);
/// Multiplies places, covariances and poses by `factor`.
void rescale(LearnedMap& map, double factor);
/// Transforms places, covariances and poses to other axes and units.
LearnedMap carried(const LearnedMap& map, const estimation::Similarity& by);
geometry::Pose carried(const geometry::Pose& pose, const estimation::Similarity& by);

}  // namespace mixrig::reconstruction
