// SPDX-License-Identifier: Apache-2.0
// What surfaces mirror of lamps and room (glTF 2.0, appendix B), and ambient light by direction, a
// register of points at a time.
#pragma once

#include "host/render/cpu/light/visibility.h"

namespace mixrig::render::cpu {

/// Linear light, x red, y green, z blue. A surface shows base (1 - metallic) (diffuse - specular
/// lost) + f0 straight + f90 grazing, with f0 = 4 % specular and f90 = specular, both of a metal
/// its base colour and 1.
struct ShadingLanes {
  VectorLanes diffuse{};
  VectorLanes straight{}, grazing{};  ///< mirrored, by Schlick's two parts of Fresnel's share
  VectorLanes lost{};                 ///< of the diffuse light below a dielectric: it was mirrored
};

/// Adds `light` times `color` to each channel.
inline void add(FloatLanes light, const glm::vec3& color, VectorLanes& sum) {
  sum.x += light * color.r, sum.y += light * color.g, sum.z += light * color.b;
}

/// How points of a surface see eye and lobe; camera axes.
struct GlossLanes {
  GlossLanes(const VectorLanes& position_m, const VectorLanes& normal, FloatLanes roughness);
  VectorLanes normal, to_eye;  ///< unit
  VectorLanes mirrored;        ///< unit: where what the eye sees in a mirror comes from
  FloatLanes alpha, across;    ///< width of the lobe; cosine of the eye
};

/// Adds what is mirrored of a lamp with `irradiance` on the points (`color`: red, green, blue of
/// it). A panel is a disc of half vectors, by whose radius the lobe is widened: at its middle that
/// is the mean of GGX over the disc.
void add_gloss(const LampParams& lamp, const VectorLanes& position_m, const GlossLanes& gloss,
               FloatLanes irradiance, const glm::vec3& color, ShadingLanes& sum);

/// Adds the ambient light on a surface: diffuse.
void add_ambient(const LightParams& light, const VectorLanes& normal, ShadingLanes& sum);
/// And what is mirrored of it: spherical harmonics, blurred as much as the lobe is wide.
void add_ambient_gloss(const LightParams& light, const GlossLanes& gloss, ShadingLanes& sum);

}  // namespace mixrig::render::cpu
