// SPDX-License-Identifier: Apache-2.0
// Finds the pose of a learned map in a scanned room.
#pragma once

#include <span>

#include "extras/map/reconstruction/maps/learned_map.h"
#include "host/math/estimation/points/rigid_fit.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::reconstruction {

/// A key picture whose pose in the room was found.
struct KeyInRoom {
  std::size_t key = 0;
  geometry::Pose room_from_camera;
  /// Covariance of (rotation vector rad, translation m) in axes of the room: R = exp(w) *
  /// R_estimate.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

struct MapInRoom {
  estimation::Similarity room_from_map;  ///< the scale: metres per unit of the map
  /// Covariance at the middle of the map's key pictures: rotation vector (rad), translation (m),
  /// log(scale).
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();
  std::size_t keys = 0, keys_agree = 0;      ///< key pictures found in the room; those that agree
  std::size_t points = 0, points_agree = 0;  ///< points over known surface; those that lie on it
  double sigma_m() const;                    ///< along the worst axis
  double sigma_rad() const;
  double scale_sigma() const;  ///< relative
};

/// Finds the similarity that most of the key pictures agree on (for a metric map first a rigid
/// motion). Then refines it by Gauss-Newton with Tukey's weights, fitting the key pictures to their
/// poses and the points to the surface of the room; a metric map's scale counts with its sigma. The
/// covariance treats errors of one key picture, and of all points in one of 32 parts of the room,
/// as common to them (Liang and Zeger 1986). Errors: kData for fewer than 3 key pictures, or 60 %
/// of them, that agree; fewer than half of the points on a surface; a scale with a sigma above 5 %.
Result<MapInRoom> place_in_room(const LearnedMap& map, const model::Panorama& room,
                                std::span<const KeyInRoom> found);

/// Transforms the map to axes of the room, in metres, and sets LearnedMap::room.
LearnedMap in_room(const LearnedMap& map, const MapInRoom& place);

}  // namespace mixrig::reconstruction
