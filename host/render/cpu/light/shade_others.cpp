// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/shade_others.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "host/render/cpu/light/shade_places.h"

namespace mixrig::render::cpu {
namespace {

/// Another surface and the row that it is in.
struct OtherAt {
  OtherSurface* surface;
  int y;
};

/// Calls shade(others, at) with a register of other surfaces of a rectangle at a time.
template <typename Shade>
void for_each_other(const LightInput& input, const Rect& rect, const VirtualLayer& layer,
                    Shade&& shade) {
  SurfaceLanes at;
  std::array<OtherAt, kLanes> others;
  int count = 0;
  const auto flush = [&] {
    // No lamp lights a normal of 0.
    for (int i = count; i < kLanes; ++i) at.set(i, {0, 0, 1}, glm::vec3(0));
    if (count > 0) shade(std::span(others).first(static_cast<std::size_t>(count)), at);
    count = 0;
  };
  for (int y = rect.y0; y < rect.y1; ++y)
    for (OtherSurface& other : layer.others.row(y)) {
      if (other.x < rect.x0 || other.x >= rect.x1) continue;
      const glm::vec3 ray = ray_of(input.tables.warp.view, other.x, y);
      at.set(count, ray / other.w, unpack(other.normal, ray));
      at.roughness[count] = static_cast<float>(other.gloss.roughness) / 255;
      others[static_cast<std::size_t>(count)] = {&other, y};
      if (++count == kLanes) flush();
    }
  flush();
}

/// Lamps that objects may hide from any other surface of a rectangle.
LampSet lamps_in_doubt(const LightInput& input, const Rect& rect, const VirtualLayer& layer) {
  float least_w = std::numeric_limits<float>::max(), most_w = 0;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (const OtherSurface& other : layer.others.row(y))
      if (other.x >= rect.x0 && other.x < rect.x1)
        least_w = std::min(least_w, other.w), most_w = std::max(most_w, other.w);
  if (!(most_w > 0)) return 0;
  return lamps_in_doubt(input.tables.warp.view, input.frame.lamps, input.maps, rect, 1 / most_w,
                        1 / least_w);
}

Rgbx16 lit_by(const LightInput& input, const VirtualLayer& layer, const OtherSurface& other,
              const ShadingLanes& light, int i) {
  return shaded(input,
                {other.albedo, layer.gloss.empty() ? nullptr : &other.gloss,
                 layer.emission.empty() ? nullptr : &other.emission, other.normal.w},
                light, i);
}

void add_to(Rgbx16& color, Rgbx16 more) {
  static constexpr int kMost = static_cast<int>(kLinearOne);
  const auto sum = [](int a, int b) { return static_cast<std::uint16_t>(std::min(a + b, kMost)); };
  color = {sum(color.r, more.r), sum(color.g, more.g), sum(color.b, more.b), 0};
}

}  // namespace

void shade_others(const LightInput& input, const Rect& rect, VirtualLayer& layer) {
  const LampSet maybe = lamps_in_doubt(input, rect, layer);
  for_each_other(input, rect, layer, [&](std::span<const OtherAt> others, const SurfaceLanes& at) {
    const ShadingLanes light = shading(input.frame, input.maps, maybe, at, {}, PastRoom::kFind, {});
    for (int i = 0; const OtherAt& o : others) {
      o.surface->lit = lit_by(input, layer, *o.surface, light, i++);
      add_to(layer.color.row(o.y)[o.surface->x], o.surface->lit);
    }
  });
}

void add_others_past_people(const LightInput& input, const PeopleMaps& people, const Rect& rect,
                            VirtualLayer& layer) {
  const LampSet maybe = people.maybe == 0 ? 0 : lamps_in_doubt(input, rect, layer);
  for_each_other(input, rect, layer, [&](std::span<const OtherAt> others, const SurfaceLanes& at) {
    ShadingLanes light;
    const bool hidden =
        people.maybe != 0 && shading_past_people(input.frame, input.maps, maybe, people, at, light);
    for (int i = 0; const OtherAt& o : others) {
      add_to(layer.color.row(o.y)[o.surface->x],
             hidden ? lit_by(input, layer, *o.surface, light, i) : o.surface->lit);
      ++i;
    }
  });
}

}  // namespace mixrig::render::cpu
