// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/irradiance.h"

#include <algorithm>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

bool holds(LampSet set, std::size_t lamp) { return lamp >= kLampBits || (set >> lamp & 1) != 0; }

/// Irradiance by an unhidden lamp of intensity 1, as CONVENTIONS.md has it. Whether there is any.
bool irradiance(const LampParams& lamp, const SurfaceLanes& at, NumberLanes& light) {
  const glm::vec3 position_m = lamp.position_m, direction = lamp.direction;
  const bool to_all_sides = direction == glm::vec3(0);
  int lit = 0;
#pragma omp simd reduction(+ : lit)
  for (int i = 0; i < kLanes; ++i) {
    const float x = position_m.x - at.position_m.x[i], y = position_m.y - at.position_m.y[i],
                z = position_m.z - at.position_m.z[i];
    const float distance2 = std::max(x * x + y * y + z * z, kLeastDistance2);
    const float receiver =
        std::max(0.0F, at.normal.x[i] * x + at.normal.y[i] * y + at.normal.z[i] * z);
    const float emitter = std::max(0.0F, -(direction.x * x + direction.y * y + direction.z * z));
    // Both cosines lack a division by the distance.
    const float distance = std::sqrt(distance2);
    light[i] = receiver * (to_all_sides ? distance : emitter) / (distance2 * distance2);
    lit += light[i] > 0;
  }
  return lit > 0;
}

}  // namespace

void light_ratio(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                 const SurfaceLanes& at, NumberLanes& ratio) {
  std::fill_n(ratio.at, kLanes, 1.0F);
  NumberLanes lost{}, light, seen;
  float most_lost = 0;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    if (!holds(maybe, k) || !irradiance(lamp, at, light)) continue;
    visibility(lamp, maps[k], at.position_m, at.normal, seen);
    const float intensity = luminance(lamp.intensity);
#pragma omp simd reduction(max : most_lost)
    for (int i = 0; i < kLanes; ++i) {
      lost[i] += intensity * light[i] * (1 - seen[i]);
      most_lost = std::max(most_lost, lost[i]);
    }
  }
  if (!(most_lost > 0)) return;
  NumberLanes all;
  std::fill_n(all.at, kLanes, luminance(frame.light.ambient));
  for (const LampParams& lamp : frame.lamps) {
    if (!irradiance(lamp, at, light)) continue;
    const float intensity = luminance(lamp.intensity);
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) all[i] += intensity * light[i];
  }
#pragma omp simd
  for (int i = 0; i < kLanes; ++i)
    ratio[i] = lost[i] > 0 ? std::max(0.0F, 1 - lost[i] / all[i]) : 1.0F;
}

void shading(const FrameParams& frame, const std::vector<ShadowMap>& maps, const SurfaceLanes& at,
             VectorLanes& light) {
  const glm::vec3 ambient = frame.light.exposure * frame.light.ambient;
  std::fill_n(light.x.at, kLanes, ambient.r);
  std::fill_n(light.y.at, kLanes, ambient.g);
  std::fill_n(light.z.at, kLanes, ambient.b);
  NumberLanes of_lamp, seen;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    if (!irradiance(lamp, at, of_lamp)) continue;
    visibility(lamp, maps[k], at.position_m, at.normal, seen);
    const glm::vec3 intensity = frame.light.exposure * lamp.intensity;
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) {
      const float share = of_lamp[i] * seen[i];
      light.x[i] += intensity.r * share;
      light.y[i] += intensity.g * share;
      light.z[i] += intensity.b * share;
    }
  }
}

}  // namespace mixrig::render::cpu
