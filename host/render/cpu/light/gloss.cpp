// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/gloss.h"

#include "host/render/contract/lobe.h"

namespace mixrig::render::cpu {
namespace {

constexpr FloatLanes kNothing{};

FloatLanes dot(const VectorLanes& a, const VectorLanes& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
VectorLanes operator*(FloatLanes f, const VectorLanes& v) { return {f * v.x, f * v.y, f * v.z}; }
VectorLanes operator+(const VectorLanes& a, const VectorLanes& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
VectorLanes operator-(const VectorLanes& a, const VectorLanes& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
FloatLanes lanes(float f) { return kNothing + f; }
FloatLanes length(const VectorLanes& v) { return sqrt(max(dot(v, v), lanes(1e-12F))); }
VectorLanes unit(const VectorLanes& v) { return (1 / length(v)) * v; }

FloatLanes power5(FloatLanes f) { return f * f * (f * f) * f; }

/// Ambient light from a direction (camera axes), with its bands scaled.
VectorLanes ambient_from(const LightParams& light, const VectorLanes& direction, FloatLanes band1,
                         FloatLanes band2) {
  if (!light.by_direction) {
    const glm::vec3 ambient = light.exposure * light.ambient;
    return {lanes(ambient.r), lanes(ambient.g), lanes(ambient.b)};
  }
  const glm::mat3& m = light.world_from_camera;
  const auto along = [&](int row) {
    return m[0][row] * direction.x + m[1][row] * direction.y + m[2][row] * direction.z;
  };
  const FloatLanes x = along(0), y = along(1), z = along(2);
  const auto channel = [&](int c) {
    const auto term = [&](std::size_t i) { return light.ambient_terms[i][c]; };
    const FloatLanes first = term(1) * y + term(2) * z + term(3) * x;
    const FloatLanes second = term(4) * (x * y) + term(5) * (y * z) + term(6) * (3 * z * z - 1) +
                              term(7) * (x * z) + term(8) * (x * x - y * y);
    return light.exposure * max(term(0) + band1 * first + band2 * second, kNothing);
  };
  return {channel(0), channel(1), channel(2)};
}

}  // namespace

GlossLanes::GlossLanes(const VectorLanes& position_m, const VectorLanes& n, FloatLanes roughness)
    : normal(n), to_eye(unit(lanes(-1) * position_m)) {
  const FloatLanes side = dot(normal, to_eye);
  mirrored = 2 * side * normal - to_eye;
  across = max(side, lanes(1e-3F));
  const FloatLanes r = max(roughness, lanes(kLeastRoughness));
  alpha = r * r;
}

void add_gloss(const LampParams& lamp, const VectorLanes& position_m, const GlossLanes& gloss,
               FloatLanes irradiance, const glm::vec3& color, ShadingLanes& sum) {
  const VectorLanes to_lamp{lamp.position_m.x - position_m.x, lamp.position_m.y - position_m.y,
                            lamp.position_m.z - position_m.z};
  const FloatLanes distance = length(to_lamp);
  const FloatLanes receiver = max(dot(gloss.normal, to_lamp) / distance, lanes(1e-3F));
  const VectorLanes half = unit((1 / distance) * to_lamp + gloss.to_eye);
  const FloatLanes a2 = gloss.alpha * gloss.alpha, seen = 0.5F * lamp.radius_m / distance;
  const FloatLanes wide2 = min(a2 + seen * seen, lanes(1));
  const FloatLanes cosine = min(max(dot(gloss.normal, half), kNothing), lanes(1));
  const FloatLanes spread = cosine * cosine * (wide2 - 1) + 1;
  const FloatLanes mask = receiver * sqrt(gloss.across * gloss.across * (1 - a2) + a2) +
                          gloss.across * sqrt(receiver * receiver * (1 - a2) + a2);
  const FloatLanes lobe = irradiance * wide2 / (spread * spread) * 0.5F / mask;
  const FloatLanes fresnel = power5(1 - min(max(dot(gloss.to_eye, half), kNothing), lanes(1)));
  add(lobe * (1 - fresnel), color, sum.straight);
  add(lobe * fresnel, color, sum.grazing);
  add(irradiance * (kDielectric + (1 - kDielectric) * fresnel), color, sum.lost);
}

void add_ambient(const LightParams& light, const VectorLanes& normal, ShadingLanes& sum) {
  sum.diffuse =
      sum.diffuse + ambient_from(light, normal, lanes(kDiffuseBand1), lanes(kDiffuseBand2));
}

void add_ambient_gloss(const LightParams& light, const GlossLanes& gloss, ShadingLanes& sum) {
  // Rougher surfaces blur the ambient light around the mirrored ray; at alpha 1 as much as diffuse
  // ones.
  const VectorLanes seen =
      ambient_from(light, gloss.mirrored, 1 + (kDiffuseBand1 - 1) * gloss.alpha,
                   1 + (kDiffuseBand2 - 1) * gloss.alpha);
  const FloatLanes r = sqrt(gloss.alpha), c = gloss.across, f2 = (1 - c) * (1 - c);
  const auto loss = [&](std::size_t i) {
    return kLobeLoss[i] + c * (kLobeLoss[i + 1] + c * kLobeLoss[i + 2]);
  };
  const auto edge = [&](std::size_t i) {
    return kLobeGrazing[i] + r * (kLobeGrazing[i + 1] + r * kLobeGrazing[i + 2]);
  };
  const FloatLanes all = 1 - r * (loss(0) + r * (loss(3) + r * loss(6)));
  const FloatLanes grazing = max(f2 * (edge(0) + f2 * edge(3)), kNothing);
  const FloatLanes straight = max(all - grazing, kNothing);
  sum.straight = sum.straight + straight * seen;
  sum.grazing = sum.grazing + grazing * seen;
  ShadingLanes diffuse;
  add_ambient(light, gloss.normal, diffuse);
  sum.lost = sum.lost + (kDielectric * straight + grazing) * diffuse.diffuse;
}

}  // namespace mixrig::render::cpu
