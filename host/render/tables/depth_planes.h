// SPDX-License-Identifier: Apache-2.0
// Planes of a depth picture, found in squares of its pixels.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"
#include "host/render/contract/passes.h"

namespace mixrig::render {

inline constexpr double kOnPlane = 2;           ///< sigmas of one depth
inline constexpr std::size_t kMostPlanes = 16;  ///< bits of a PlaneSet
using PlaneSet = std::uint16_t;

/// Inverse depth at a ray (x/z, y/z): a plane.
struct WPlane {
  Eigen::Vector3d abc{0, 0, 0};
  double at(double x, double y) const { return abc.x() * x + abc.y() * y + abc.z(); }
};

/// Mean of the depths of a square of pixels.
struct Cell {
  double x = 0, y = 0, w = 0, sigma = 1;  ///< w 0: less than half is known
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

/// Of the inverse depth of one measurement.
inline double sigma_w(const NoiseParams& noise, double w) {
  return static_cast<double>(noise.sigma_m(static_cast<float>(1 / w))) * w * w;
}

Cells make_cells(ImageView<const float> depth_m, const geometry::Pinhole& view,
                 const NoiseParams& noise, int side_px);

/// Planes that at least 1 % of the known cells show, at most kMostPlanes, the largest first. Pure.
std::vector<WPlane> find_planes(const Cells& cells);

/// Of each cell the planes that a region reaches to which the cells around lie alike. Pure.
std::vector<PlaneSet> planes_near(const Cells& cells, const std::vector<WPlane>& planes);

}  // namespace mixrig::render
