// SPDX-License-Identifier: Apache-2.0
// Virtual objects as convex parts.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mixrig::touch {

/// Points p with normal . p <= offset_m are on its inner side; the normal has length 1.
struct Plane {
  Eigen::Vector3f normal;
  float offset_m = 0;
};

/// Planes in groups of like normals, so that few of them are looked at: exact, about the middle of
/// the part's box.
struct PlaneGroups {
  static constexpr int kSize = 16, kMost = 32;  ///< planes of a group, groups
  struct Group {
    Eigen::Array<float, kSize, 1> x, y, z, offset_m;
  };
  /// Of each group: no plane of it is farther from p than x p.x + y p.y + z p.z - offset_m +
  /// spread |p|.
  Eigen::Array<float, kMost, 1> x, y, z, offset_m, spread;
  std::vector<Group> groups;
  std::vector<Plane> planes;  ///< in this order; the first of a group fills its end

  /// The plane that is least behind p, and by how much.
  std::pair<float, int> farthest(const Eigen::Vector3f& p) const;
};

struct Convex {
  std::vector<Eigen::Vector3f> corners_m;
  std::vector<Plane> planes;
  PlaneGroups groups;  ///< of the same planes where they are many; else empty
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

/// Farther from an object nothing is looked at.
inline constexpr float kNear_m = 0.25F;

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
