// SPDX-License-Identifier: Apache-2.0
// Large planes in a depth picture, and how flat they are.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::depth {

/// Rays of a camera's pixels: x/z and y/z; NaN where the lens has none.
struct PixelRays {
  explicit PixelRays(const geometry::CameraModel& camera);
  Eigen::Vector3d at(int px, int py) const { return {x.at(px, py), y.at(px, py), 1}; }
  /// Turns distances along the rays, in place, into depths along the axis; NaN where the lens has
  /// no ray. Precondition: the camera's size.
  void to_depth(ImageView<float> distance_m) const;
  /// Turns depths back into distances, in place.
  void to_distance(ImageView<float> z_m) const;
  Image<float> x, y;
};

/// A square of pixels. On a plane the mean of 1/z is linear in the mean ray.
struct DepthCell {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();  ///< mean, with z = 1
  double inverse_per_m = 0;                        ///< mean of 1/z; 0: too few pixels, or an edge
  double sigma_m = 0;                              ///< noise of the cell's mean, along the axis
  double area_per_m2 = 0;                          ///< area of the cell in the plane z = 1

  Eigen::Vector3d point_m() const { return ray / inverse_per_m; }
};

struct CellGrid {
  int side_px = 0;
  Size size;                     ///< in cells
  std::vector<DepthCell> cells;  ///< row by row
};

/// Divides a picture into cells, at least 4 pixels wide and about 64 in a row. `z_m`: along the
/// axis, size of the rays; unknown where not positive or not finite.
CellGrid cells_of(ImageView<const float> z_m, const PixelRays& rays);

/// Points p with inverse_per_m . p = 1, and the cells that lie on it.
struct SeenPlane {
  Eigen::Vector3d inverse_per_m = Eigen::Vector3d::UnitZ();
  std::vector<int> cells;  ///< indices into CellGrid::cells

  Eigen::Vector3d normal() const { return inverse_per_m.normalized(); }
  /// Distance along the normal, positive beyond the plane.
  double beyond_m(const Eigen::Vector3d& p_m) const {
    return (inverse_per_m.dot(p_m) - 1) / inverse_per_m.norm();
  }
};

/// The plane of least squared distances to cells; keeps `cells`. Zero inverse_per_m where they do
/// not determine a plane.
SeenPlane fit_cells(const CellGrid& grid, std::vector<int> cells);

/// Finds connected planes that take up at least 4 % of the picture. A cell belongs to a plane if
/// it lies within 20 mm and 1 % of its depth of it.
std::vector<SeenPlane> find_planes(const CellGrid& grid);

/// How far a plane's cells are from flat; the noise of the cells is subtracted.
struct Flatness {
  double distance_m = 0;  ///< from the camera, median of the cells
  double area_m2 = 0;
  double rms_m = 0;   ///< of the cells' distances to the plane
  double bend_m = 0;  ///< part of rms_m that a polynomial of second order over the plane explains
};
Flatness flatness_of(const CellGrid& grid, const SeenPlane& plane);

}  // namespace mixrig::depth
