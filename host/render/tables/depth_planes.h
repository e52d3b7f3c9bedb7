// SPDX-License-Identifier: Apache-2.0
// Finds planes in a depth picture, from the means over square cells of its pixels.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/render/contract/passes.h"

namespace mixrig::render {
inline constexpr double kOnPlane = 2;  ///< largest residual of a cell on a plane, in its sigmas
inline constexpr std::size_t kMostPlanes = 16;  ///< bits of a PlaneSet
using PlaneSet = std::uint16_t;

/// A plane as inverse depth, 1/m, affine in the ray (x/z, y/z).
struct WPlane {
  Eigen::Vector3d abc{0, 0, 0};
  double at(double x, double y) const { return abc.x() * x + abc.y() * y + abc.z(); }
};

/// Mean of a square of pixels: ray (x/z, y/z), inverse depth w (1/m) and sigma of w for one
/// measurement.
struct Cell {
  double x = 0, y = 0, w = 0, sigma = 1;  ///< w 0: less than half of the pixels are known
  double residual(const WPlane& plane) const { return (w - plane.at(x, y)) / sigma; }
};

struct Cells {
  int side_px = 1, columns = 0, rows = 0;
  std::vector<Cell> cells;
  const Cell& at(int i, int j) const {
    return cells[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(i)];
  }
};

/// Standard deviation of the inverse depth of one measurement, 1/m.
inline double sigma_w(const NoiseParams& noise, double w) {
  return static_cast<double>(noise.sigma_m(static_cast<float>(1 / w))) * w * w;
}

Cells make_cells(ImageView<const float> depth_m, const geometry::Pinhole& view,
                 const NoiseParams& noise, int side_px);

/// Returns planes that at least 1 % of the known cells lie on, at most kMostPlanes, the largest
/// first. Pure.
std::vector<WPlane> find_planes(const Cells& cells);

/// For each cell, the planes on which the cells around it lie, alike on both sides of the plane,
/// and such planes of the cells up to two beside it. Pure.
std::vector<PlaneSet> planes_near(const Cells& cells, const std::vector<WPlane>& planes);

}  // namespace mixrig::render
