// SPDX-License-Identifier: Apache-2.0
// Virtual objects as convex parts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mixrig::touch {

/// Farther from an object nothing is looked at.
inline constexpr float kNear_m = 0.25F;

/// Points p with normal . p <= offset_m are on its inner side; the normal has length 1.
struct Plane {
  Eigen::Vector3f normal;
  float offset_m = 0;
};

/// Cells around a part, each with the planes that a point in it may be farthest from. Exact.
struct PlaneGrid {
  static constexpr int kCells = 20;  ///< a side
  Eigen::Vector3f corner_m = Eigen::Vector3f::Zero(), cells_per_m = Eigen::Vector3f::Zero();
  std::vector<std::uint32_t> first;  ///< of each cell in `planes`, and the end; empty: no grid
  std::vector<std::uint16_t> planes;

  /// Those for a point; none where it is farther than kNear_m from the box.
  std::span<const std::uint16_t> near(const Eigen::Vector3f& p) const;
};

struct Convex {
  std::vector<Eigen::Vector3f> corners_m;
  std::vector<Plane> planes;
  PlaneGrid grid;  ///< where there are many planes
  Eigen::AlignedBox3f box_m;

  /// Inside minus the distance to the surface. Outside at most the distance, and equal to it before
  /// a face. `normal`: of the face that it is before.
  float distance_m(const Eigen::Vector3f& p, Eigen::Vector3f& normal) const;
};

/// Object axes, scaled.
struct Shape {
  std::vector<Convex> parts;
  Eigen::AlignedBox3f box_m;

  /// The least of the parts.
  float distance_m(const Eigen::Vector3f& p, Eigen::Vector3f& normal) const;
};

struct Triangles {
  std::span<const Eigen::Vector3f> positions_m;
  std::span<const std::uint32_t> indices;  ///< three a triangle
};

inline constexpr std::size_t kMostParts = 64;      ///< of an object; with more a mesh is one part
inline constexpr std::size_t kMostCorners = 256;   ///< of a part; of more the outermost are taken
inline constexpr float kLeastThickness_m = 0.01F;  ///< of a part

/// The convex hull of each connected part of the meshes (vertices at one place are one). Empty
/// where there is no triangle. Pure.
Shape make_shape(std::span<const Triangles> meshes, double scale);
/// Pure. Precondition: the box is not empty.
Shape box_shape(const Eigen::AlignedBox3f& box_m);

}  // namespace mixrig::touch
