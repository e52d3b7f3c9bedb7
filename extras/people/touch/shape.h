// SPDX-License-Identifier: Apache-2.0
// Models virtual objects as convex parts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mixrig::touch {

/// Distance from an object up to which gaps are measured.
inline constexpr float kNear_m = 0.25F;

/// Half space: points p with normal . p <= offset_m are inside; the normal has length 1.
struct Plane {
  Eigen::Vector3f normal;
  float offset_m = 0;
};

/// Grid around a part. Each cell lists the planes that can be the farthest for a point in it.
/// Exact.
struct PlaneGrid {
  static constexpr int kCells = 20;  ///< a side
  Eigen::Vector3f corner_m = Eigen::Vector3f::Zero(), cells_per_m = Eigen::Vector3f::Zero();
  std::vector<std::uint32_t> first;  ///< of each cell in `planes`, and the end; empty: no grid
  std::vector<std::uint16_t> planes;

  /// Planes for a point; empty where it is farther than kNear_m from the box.
  std::span<const std::uint16_t> near(const Eigen::Vector3f& p) const;
};

struct Convex {
  std::vector<Eigen::Vector3f> corners_m;
  std::vector<Plane> planes;
  PlaneGrid grid;  ///< where there are many planes
  Eigen::AlignedBox3f box_m;

  /// Signed distance to the surface, negative inside. Outside it is a lower bound, which is exact
  /// in front of a face. `normal`: set to that of the face that gives it.
  float distance_m(const Eigen::Vector3f& p, Eigen::Vector3f& normal) const;
};

/// Convex parts of an object, in object axes, scaled.
struct Shape {
  std::vector<Convex> parts;
  Eigen::AlignedBox3f box_m;

  /// Least distance_m() of the parts.
  float distance_m(const Eigen::Vector3f& p, Eigen::Vector3f& normal) const;
};

struct Triangles {
  std::span<const Eigen::Vector3f> positions_m;
  std::span<const std::uint32_t> indices;  ///< three a triangle
};

inline constexpr std::size_t kMostParts = 64;      ///< of an object; with more a mesh is one part
inline constexpr std::size_t kMostCorners = 256;   ///< of a part; of more the outermost are taken
inline constexpr float kLeastThickness_m = 0.01F;  ///< of a part

/// Makes the convex hull of each connected part of the meshes (vertices at one place are one).
/// Empty where there is no triangle. Pure.
Shape make_shape(std::span<const Triangles> meshes, double scale);
/// Shape of a box. Pure. Precondition: the box is not empty.
Shape box_shape(const Eigen::AlignedBox3f& box_m);

}  // namespace mixrig::touch
