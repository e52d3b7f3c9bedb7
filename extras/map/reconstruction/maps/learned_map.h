// SPDX-License-Identifier: Apache-2.0
// What a sequence of pictures says about a room: places, how they look, and where the camera was.
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

/// A place of the room in axes and units of the map.
struct MapPoint {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  /// Covariance of `place`, m^2, with the poses of the key frames fixed.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int views = 0;                                 ///< key pictures that see it
  int key = 0;                                   ///< the key picture that its look is taken from
  Eigen::Vector2d px = Eigen::Vector2d::Zero();  ///< in that picture
};

/// How a point looks in one key picture.
struct MapDescriptor {
  int point = 0;
  Descriptor values{};
};

struct MapKey {
  double time_s = 0;
  geometry::Pose map_from_camera;
  Image<std::uint8_t> grey;
};

/// The scale of a map in metres; absent: not known, and the extent of the path is 1.
struct MapScale {
  double sigma = 0;      ///< relative
  int measurements = 0;  ///< distances that it comes from
};

/// Of a map in axes of a scanned room: how well its place is known, and where the room stands.
struct RoomAxes {
  double sigma_m = 0, sigma_rad = 0;  ///< of the place, along the worst axis
  std::optional<geometry::Pose> world_from_room;
};

/// Axes: those of the camera at the first key picture that was solved, or of `room`; units: metres,
/// or as `scale` says.
struct LearnedMap {
  std::string camera;  ///< "fisheye" or "target": whose pictures
  std::string calibration_hash;
  std::optional<MapScale> scale;
  std::optional<RoomAxes> room;
  int pictures = 0;        ///< that were looked at
  double residual_px = 0;  ///< root mean square of a coordinate, of the key pictures
  std::vector<MapKey> keys;
  std::vector<MapPoint> points;
  std::vector<MapDescriptor> descriptors;
  std::vector<trajectory::TimedPose> path;  ///< map_from_camera of all pictures with a pose
};

/// Largest distance between two places of the path.
double extent_of(const std::vector<trajectory::TimedPose>& path);
/// Places, covariances and poses times `factor`.
void rescale(LearnedMap& map, double factor);
/// Places, covariances and poses in other axes and units.
LearnedMap carried(const LearnedMap& map, const estimation::Similarity& by);
geometry::Pose carried(const geometry::Pose& pose, const estimation::Similarity& by);

}  // namespace mixrig::reconstruction
