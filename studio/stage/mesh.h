// SPDX-License-Identifier: Apache-2.0
// Triangle meshes for the tracer, and the basic shapes of room and person.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace mixrig::studio {

using Vec2 = Eigen::Vector2f;
using Vec3 = Eigen::Vector3f;

/// Kind of surface; materials.h gives its albedo.
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
  kObject,
  kMirror,
  kStrand,
  kStick,
  kBlack,
  kChrome,
  kGlass
};
struct Material {
  Kind kind = Kind::kPaint;
  std::uint8_t variant = 0;  ///< colour, picture or body part within the kind
  std::uint8_t person = 0;   ///< whose body or clothes
  bool operator==(const Material&) const = default;
};

/// Whether a kind is so thin that it can lie between the corners of a pixel unseen.
inline bool is_thin(Kind kind) { return kind == Kind::kStrand || kind == Kind::kStick; }

struct Mesh {
  std::vector<Vec3> positions, normals;  ///< normals have length 1
  std::vector<Vec2> uv;                  ///< metres along the surface unless stated otherwise
  std::vector<std::uint32_t> indices;    ///< three per triangle
  std::vector<Material> materials;       ///< one per triangle

  void clear();
};

/// One ellipse of a loft: perpendicular half axes, and the texture's v.
struct Ring {
  Vec3 centre, half_x, half_y;
  float v = 0;
};

/// A parallelogram from `corner` along two edges; its normal is a x b, uv in metres.
void add_quad(Mesh& mesh, const Vec3& corner, const Vec3& a, const Vec3& b, Material material);
/// One triangle.
void add_flat(Mesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, Material material);
/// A box rotated about z by `yaw_rad`; `centre` is the centre of its bottom face.
void add_box(Mesh& mesh, const Vec3& centre, const Vec3& size, float yaw_rad, Material material);
/// A smooth closed surface through rings, both ends capped; u is 0..1 around, starting at half_x.
void add_loft(Mesh& mesh, std::span<const Ring> rings, int segments, Material material);
/// A tube from a to b with a radius at each end and rounded ends.
void add_limb(Mesh& mesh, const Vec3& a, const Vec3& b, float radius_a, float radius_b,
              int segments, Material material);
/// An upright cylinder; `foot` is the centre of its bottom.
void add_cylinder(Mesh& mesh, const Vec3& foot, float radius, float height, int segments,
                  Material material);
/// An ellipsoid with the given perpendicular half axes.
void add_ellipsoid(Mesh& mesh, const Vec3& centre, const Vec3& half_x, const Vec3& half_y,
                   const Vec3& half_z, int segments, Material material);

}  // namespace mixrig::studio
