// SPDX-License-Identifier: Apache-2.0
// Triangles for the tracer, and the shapes that the room and the person are made of.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace mixrig::studio {

using Vec2 = Eigen::Vector2f;
using Vec3 = Eigen::Vector3f;

/// What a surface is made of; materials.h turns it into albedo.
enum class Kind : std::uint8_t {
  kFloor,
  kWall,
  kCeiling,
  kLamp,
  kWood,
  kDarkWood,
  kMetal,
  kPaint,
  kPoster,
  kBook,
  kCloth,
  kDoor,
  kSkin,
  kFace,
  kHair,
  kShirt,
  kTrousers,
  kShoe,
  kObject
};
struct Material {
  Kind kind = Kind::kPaint;
  std::uint8_t variant = 0;  ///< colour, picture or body part within the kind
  bool operator==(const Material&) const = default;
};

struct Mesh {
  std::vector<Vec3> positions, normals;  ///< normals have length 1
  std::vector<Vec2> uv;                  ///< metres along the surface unless a shape says other
  std::vector<std::uint32_t> indices;    ///< three a triangle
  std::vector<Material> materials;       ///< one a triangle

  void clear();
};

/// One ellipse of a loft: two half axes at right angles and the texture's v.
struct Ring {
  Vec3 centre, half_x, half_y;
  float v = 0;
};

/// A parallelogram from `corner` along two edges; its normal is a x b, uv in metres.
void add_quad(Mesh& mesh, const Vec3& corner, const Vec3& a, const Vec3& b, Material material);
/// A box that is turned about z by `yaw_rad`; `centre` is that of its bottom face.
void add_box(Mesh& mesh, const Vec3& centre, const Vec3& size, float yaw_rad, Material material);
/// A closed skin over rings, smooth, both ends capped; u runs 0..1 around from half_x.
void add_loft(Mesh& mesh, std::span<const Ring> rings, int segments, Material material);
/// A tube from a to b with a radius at each end, ends rounded off.
void add_limb(Mesh& mesh, const Vec3& a, const Vec3& b, float radius_a, float radius_b,
              int segments, Material material);
/// An upright cylinder on `foot`.
void add_cylinder(Mesh& mesh, const Vec3& foot, float radius, float height, int segments,
                  Material material);
/// An ellipsoid with given half axes (at right angles).
void add_ellipsoid(Mesh& mesh, const Vec3& centre, const Vec3& half_x, const Vec3& half_y,
                   const Vec3& half_z, int segments, Material material);

}  // namespace mixrig::studio
