// SPDX-License-Identifier: Apache-2.0
// Reflections of lamps and room (glTF 2.0, appendix B), and ambient light by direction, for a
// register of points at a time.
#pragma once

#include "host/render/cpu/light/visibility.h"

namespace mixrig::render::cpu {

/// Linear light, x red, y green, z blue. The colour of a surface is base (1 - metallic) (diffuse -
/// specular lost) + f0 straight + f90 grazing. f0 is 4 % specular and f90 is specular; for a metal
/// they are its base colour and 1.
struct ShadingLanes {
  VectorLanes diffuse{};
  /// Reflected light, by the two parts of Schlick's Fresnel term.
  VectorLanes straight{}, grazing{};
  VectorLanes lost{};  ///< diffuse light that a dielectric lacks because it is reflected
};

/// Adds `light` times `color` to each channel.
inline void add(FloatLanes light, const glm::vec3& color, VectorLanes& sum) {
  sum.x += light * color.r, sum.y += light * color.g, sum.z += light * color.b;
}

/// View and lobe at points of a surface, in camera axes.
struct GlossLanes {
  GlossLanes(const VectorLanes& position_m, const VectorLanes& normal, FloatLanes roughness);
  VectorLanes normal, to_eye;  ///< unit
  VectorLanes mirrored;        ///< unit direction from which a mirror's light would come
  FloatLanes alpha, across;    ///< width of the lobe; cosine of the view direction
};

/// Adds the reflection of a lamp with `irradiance` on the points (`color`: its red, green, blue). A
/// panel is a disc of half vectors, by whose radius the lobe is widened: at its centre that equals
/// the mean of GGX over the disc.
void add_gloss(const LampParams& lamp, const VectorLanes& position_m, const GlossLanes& gloss,
               FloatLanes irradiance, const glm::vec3& color, ShadingLanes& sum);

/// Adds the diffuse ambient light on a surface.
void add_ambient(const LightParams& light, const VectorLanes& normal, ShadingLanes& sum);
/// Adds the reflected ambient light: spherical harmonics, blurred by the width of the lobe.
void add_ambient_gloss(const LightParams& light, const GlossLanes& gloss, ShadingLanes& sum);

}  // namespace mixrig::render::cpu
