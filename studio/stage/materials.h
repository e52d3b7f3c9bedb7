// SPDX-License-Identifier: Apache-2.0
// Procedural textures: visible and infrared albedo of surfaces.
#pragma once

#include "studio/stage/mesh.h"
#include "studio/studio.h"

namespace mixrig::studio {

/// Clothes, skin and hair of the person, linear RGB albedo.
struct Wardrobe {
  Vec3 shirt, shirt_second, trousers, shoes, skin, hair;
  int pattern = 0;           ///< 0 plain, 1 stripes, 2 checks, 3 print on the chest
  float infrared_cloth = 0;  ///< added to the cloth's infrared albedo: dyes reflect infrared
};

/// Random clothes; dark ones for `dark`.
Wardrobe choose_wardrobe(unsigned seed, bool dark);

/// Dresses a person in shirt and trousers of the colour of the far wall.
Wardrobe wall_coloured(Wardrobe wardrobe);

/// Albedo of surfaces. Refers to the object's textures (Material::variant is their index); the
/// object must outlive it.
class Materials {
 public:
  Materials(unsigned seed, const Wardrobe& wardrobe, const VirtualObject* object);

  /// Adds the clothes of another person, who has the next number of Material::person.
  void add(const Wardrobe& wardrobe) { wardrobes_.push_back(wardrobe); }

  /// Sets the level of the lamps; 1 at first.
  void set_lamp_level(float level) { lamp_level_ = level; }
  /// Linear RGB albedo, 0..1; for Kind::kLamp the emitted light.
  Vec3 albedo(Material material, const Vec2& uv, const Vec3& position_m) const;
  /// Albedo at the ToF camera's 850 nm.
  float infrared(Material material, const Vec3& visible) const;

 private:
  Vec3 room(Material material, const Vec2& uv) const;
  Vec3 face(const Wardrobe& wardrobe, const Vec2& uv) const;
  Vec3 shirt(const Wardrobe& wardrobe, Material material, const Vec2& uv) const;

  std::uint64_t seed_;
  std::vector<Wardrobe> wardrobes_;
  const VirtualObject* object_;
  float lamp_level_ = 1;
};

}  // namespace mixrig::studio
