// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace mixrig::render::cpu {
namespace {

bool holds(LampSet set, std::size_t lamp) { return lamp >= kLampBits || (set >> lamp & 1) != 0; }

/// Irradiance by an unhidden lamp of intensity 1, as CONVENTIONS.md has it.
FloatLanes irradiance(const LampParams& lamp, const SurfaceLanes& at) {
  const FloatLanes x = lamp.position_m.x - at.position_m.x, y = lamp.position_m.y - at.position_m.y,
                   z = lamp.position_m.z - at.position_m.z;
  const FloatLanes distance2 = max(x * x + y * y + z * z, FloatLanes{} + kLeastDistance2);
  const FloatLanes receiver =
      max(at.normal.x * x + at.normal.y * y + at.normal.z * z, FloatLanes{});
  // Both cosines lack a division by the distance.
  const glm::vec3 d = lamp.direction;
  const FloatLanes emitter =
      d == glm::vec3(0) ? sqrt(distance2) : max(-(x * d.x + y * d.y + z * d.z), FloatLanes{});
  return receiver * emitter / (distance2 * distance2);
}

}  // namespace

FloatLanes light_ratio(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                       const SurfaceLanes& at) {
  const FloatLanes one = FloatLanes{} + 1.0F;
  FloatLanes lost{};
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    if (!holds(maybe, k)) continue;
    const FloatLanes light = irradiance(lamp, at);
    if (!any(light > 0)) continue;
    lost += light * (1 - visibility(lamp, maps[k], at.position_m, at.normal)) *
            luminance(lamp.intensity);
  }
  if (!any(lost > 0)) return one;
  FloatLanes all = FloatLanes{} + luminance(frame.light.ambient);
  for (const LampParams& lamp : frame.lamps)
    all += irradiance(lamp, at) * luminance(lamp.intensity);
  return lost > 0 ? max(1 - lost / all, FloatLanes{}) : one;
}

namespace {

/// `maybe`: lamps that objects may hide; `share`: of the first lamps that is seen past people, the
/// others are not hidden by them.
VectorLanes shading_of(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                       std::span<const FloatLanes> share, const SurfaceLanes& at) {
  const glm::vec3 ambient = frame.light.exposure * frame.light.ambient;
  VectorLanes light{FloatLanes{} + ambient.r, FloatLanes{} + ambient.g, FloatLanes{} + ambient.b};
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    FloatLanes of_lamp = irradiance(lamp, at);
    if (k < share.size()) of_lamp *= share[k];
    if (!any(of_lamp > 0)) continue;
    if (holds(maybe, k)) of_lamp *= visibility(lamp, maps[k], at.position_m, at.normal);
    const glm::vec3 intensity = frame.light.exposure * lamp.intensity;
    light.x += of_lamp * intensity.r;
    light.y += of_lamp * intensity.g;
    light.z += of_lamp * intensity.b;
  }
  return light;
}

}  // namespace

VectorLanes shading(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                    const SurfaceLanes& at) {
  return shading_of(frame, maps, maybe, {}, at);
}

bool shading_past_people(const FrameParams& frame, const std::vector<ShadowMap>& maps,
                         LampSet maybe, const PeopleMaps& people, const SurfaceLanes& at,
                         VectorLanes& light) {
  std::array<FloatLanes, kMostLamps> share;
  const std::size_t count = std::min(maps.size(), share.size());
  bool hidden = false;
  for (std::size_t k = 0; k < count; ++k) {
    share[k] = FloatLanes{} + 1.0F;
    if (!holds(people.maybe, k)) continue;
    share[k] = visibility(people.lamps[k], people.maps[k], at.position_m, at.normal);
    hidden |= any(share[k] < 1);
  }
  if (hidden) light = shading_of(frame, maps, maybe, std::span(share).first(count), at);
  return hidden;
}

}  // namespace mixrig::render::cpu
