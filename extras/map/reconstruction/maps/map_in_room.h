// SPDX-License-Identifier: Apache-2.0
// Where a learned map lies in a scanned room.
#pragma once

#include <span>

#include "extras/map/reconstruction/maps/learned_map.h"
#include "host/math/estimation/points/rigid_fit.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::reconstruction {

/// A key picture that the room explains.
struct KeyInRoom {
  std::size_t key = 0;
  geometry::Pose room_from_camera;
  /// Of (rotation vector rad, translation m) in axes of the room: R = exp(w) * R_estimate.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

struct MapInRoom {
  estimation::Similarity room_from_map;  ///< the scale: metres per unit of the map
  /// Of the middle of the map's key pictures (rotation vector rad, translation m) and log(scale).
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
  std::size_t keys = 0, keys_agree = 0;      ///< that the room explains; of them those of one place
  std::size_t points = 0, points_agree = 0;  ///< over known surface; of them those on it
  double sigma_m() const;                    ///< along the worst axis
  double sigma_rad() const;
  double scale_sigma() const;  ///< relative
};

/// The similarity that most of the key pictures agree on (of a metric map a rigid motion first),
/// then, by Gauss-Newton with Tukey's weights, the one that lays the key pictures on their poses
/// and the points on the surface of the room; a metric map's scale counts with its sigma. The
/// covariance takes errors of one key picture, and of all points of one of 32 parts of the room, as
/// common to them (Liang and Zeger 1986). Errors: kData for fewer than 3 key pictures, or 60 % of
/// them, that agree; fewer than half of the points on a surface; a scale with a sigma above 5 %.
Result<MapInRoom> place_in_room(const LearnedMap& map, const model::Panorama& room,
                                std::span<const KeyInRoom> found);

/// The map in axes of the room, in metres; LearnedMap::room is set.
LearnedMap in_room(const LearnedMap& map, const MapInRoom& place);

}  // namespace mixrig::reconstruction
