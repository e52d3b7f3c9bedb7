// SPDX-License-Identifier: Apache-2.0
// Queries on a scanned room: surfaces, places behind walls, lines of sight.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::lights {

/// A point on a surface of the room, world axes.
struct SurfacePoint {
  Eigen::Vector3d position_m;
  Eigen::Vector3d normal;  ///< unit, into the room
  double sigma_m = 0;      ///< of its distance from the scan's origin
  int x = 0, y = 0;        ///< pixel of the panorama's distances
};

/// Immutable; may be used by any thread. Owns the panorama.
class RoomSurfaces {
 public:
  RoomSurfaces(model::Panorama panorama, const geometry::Pose& world_from_base);

  const model::Panorama& panorama() const { return panorama_; }
  const geometry::Pose& world_from_base() const { return world_from_base_; }
  const std::vector<model::RoomPlane>& planes() const { return planes_; }

  /// The surface at a pixel of the panorama; nullopt if it or its neighbours are unknown.
  std::optional<SurfacePoint> at(int x, int y) const;
  /// The surface that the scan saw in the direction of a point.
  std::optional<SurfacePoint> towards(const Eigen::Vector3d& position_m) const;
  /// The first surface on a ray, in at most 400 steps of 3 cm or more; nullopt if it meets none.
  std::optional<SurfacePoint> meet(const Eigen::Vector3d& from_m, const Eigen::Vector3d& ray,
                                   double most_m = 20) const;
  /// Whether a point lies more than `margin_m` behind a large plane that continues around it: seen
  /// in a mirror, through a window, or below the floor.
  bool behind_plane(const Eigen::Vector3d& position_m, double margin_m) const;
  /// Whether no known surface lies between two points; 4 cm at either end are ignored.
  bool open(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) const;

 private:
  struct Pixel {
    int x = 0, y = 0;
    double distance_m = 0;  ///< distance of the point from the origin
  };
  Pixel pixel_of(const Eigen::Vector3d& in_base_m) const;
  std::optional<double> first_hit(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                                  double skip_m) const;

  model::Panorama panorama_;
  geometry::Pose world_from_base_, base_from_world_;
  std::vector<model::RoomPlane> planes_;
};

}  // namespace mixrig::lights
