// SPDX-License-Identifier: Apache-2.0
// Pass light: places of virtual surfaces at which light is evaluated, and their colour.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "host/render/cpu/light/light_parts.h"

namespace mixrig::render::cpu {

inline glm::vec3 lane(const VectorLanes& v, int i) { return {v.x[i], v.y[i], v.z[i]}; }

/// Colour of a glossy surface with albedo `base`, premultiplied by `coverage`, both scaled by
/// kLinearOne.
inline glm::vec3 mirroring(const glm::vec3& base, float coverage, GlossBytes gloss,
                           const ShadingLanes& light, int i) {
  const float metallic = static_cast<float>(gloss.metallic) / 255;
  const float specular = static_cast<float>(gloss.specular) / 255;
  const glm::vec3 straight = glm::mix(glm::vec3(kDielectric * specular * coverage), base, metallic);
  const float grazing = glm::mix(specular, 1.0F, metallic) * coverage;
  const glm::vec3 diffuse =
      glm::max(lane(light.diffuse, i) - specular * lane(light.lost, i), glm::vec3(0));
  return (1 - metallic) * base * diffuse + straight * lane(light.straight, i) +
         grazing * lane(light.grazing, i);
}

/// Material of a surface in a pixel, premultiplied by its share.
struct Matter {
  Rgbx16 albedo;
  const GlossBytes* gloss = nullptr;  ///< null if no object is glossy
  const Rgbx16* emission = nullptr;   ///< null if no object emits
  int share = 0;                      ///< of the pixel, kWholeShare = 1
};

/// Colour of a surface, premultiplied like its albedo.
inline Rgbx16 shaded(const LightInput& input, const Matter& of, const ShadingLanes& light, int i) {
  glm::vec3 c(of.albedo.r, of.albedo.g, of.albedo.b);
  if (of.gloss == nullptr) {
    c *= lane(light.diffuse, i);
  } else {
    const float coverage = kLinearOne / kWholeShare * static_cast<float>(of.share);
    c = mirroring(c, coverage, *of.gloss, light, i);
  }
  if (of.emission != nullptr)
    c += input.frame.light.exposure * glm::vec3(of.emission->r, of.emission->g, of.emission->b);
  c = glm::min(c + 0.5F, glm::vec3(kLinearOne));
  return {static_cast<std::uint16_t>(c.r), static_cast<std::uint16_t>(c.g),
          static_cast<std::uint16_t>(c.b), 0};
}

/// Colour of a pixel's nearest surface, which has `albedo`.
inline Rgbx16 shaded(const LightInput& input, const VirtualLayer& layer, int x, int y,
                     Rgbx16 albedo, const ShadingLanes& light, int i) {
  return shaded(
      input,
      {albedo, layer.gloss.empty() ? nullptr : layer.gloss.row(y) + x,
       layer.emission.empty() ? nullptr : layer.emission.row(y) + x, layer.normal.row(y)[x].w},
      light, i);
}

/// Whether the 2x2 pixels from (x, y) on show one smooth surface, so that one evaluation does for
/// all.
inline bool is_smooth(const VirtualLayer& layer, int x, int y) {
  constexpr float kAlike = 0.01F;  ///< relative, of the inverse depth
  const auto same = [&](int i, int j) {
    const PackedNormal a = layer.normal.row(y)[x], b = layer.normal.row(y + j)[x + i];
    const float w = layer.w.row(y)[x];
    return layer.coverage.row(y + j)[x + i] > 0 && a.x == b.x && a.y == b.y && a.z == b.z &&
           std::abs(layer.w.row(y + j)[x + i] - w) < kAlike * w;
  };
  return same(0, 0) && same(1, 0) && same(0, 1) && same(1, 1);
}

/// A square of pixels that one evaluation of the lamps serves.
struct Place {
  int x = 0, y = 0, side = 1;
};

/// Whether 2x2 smooth pixels are evaluated together.
enum class Squares { kSingle, kOfTwo };

/// Calls shade(places, at) with a register of places at a time, for the covered pixels of a tile
/// whose 2x2 square is wanted(x, y).
template <Squares squares, typename Wanted, typename Shade>
void for_each_place(const LightInput& input, const Rect& tile, const VirtualLayer& layer,
                    Wanted&& wanted, Shade&& shade) {
  SurfaceLanes at;
  std::array<Place, kLanes> places;
  int count = 0;
  const auto flush = [&] {
    for (int i = count; i < kLanes; ++i) at.set(i, {0, 0, 1}, glm::vec3(0));  // no lamp lights it
    if (count > 0) shade(std::span(places).first(static_cast<std::size_t>(count)), at);
    count = 0;
  };
  const auto add = [&](const Place& p) {
    if (layer.coverage.row(p.y)[p.x] == 0) return;
    const glm::vec3 ray = ray_of(input.tables.warp.view, p.x, p.y);
    at.set(count, ray / layer.w.row(p.y)[p.x], unpack(layer.normal.row(p.y)[p.x], ray));
    if (!layer.gloss.empty())
      at.roughness[count] = static_cast<float>(layer.gloss.row(p.y)[p.x].roughness) / 255;
    places[static_cast<std::size_t>(count)] = p;
    if (++count == kLanes) flush();
  };
  for (int y = tile.y0; y < tile.y1; y += 2)
    for (int x = tile.x0; x < tile.x1; x += 2) {
      if (!wanted(x, y)) continue;
      if (squares == Squares::kOfTwo && y + 1 < tile.y1 && x + 1 < tile.x1 &&
          is_smooth(layer, x, y)) {
        add({x, y, 2});
        continue;
      }
      for (int j = y; j < std::min(y + 2, tile.y1); ++j)
        for (int i = x; i < std::min(x + 2, tile.x1); ++i) add({i, j, 1});
    }
  flush();
}

/// Calls set(x, y, i) for each pixel of square number i.
template <typename Set>
void for_each_pixel(std::span<const Place> places, Set&& set) {
  for (int i = 0; const Place& p : places) {
    for (int y = p.y; y < p.y + p.side; ++y)
      for (int x = p.x; x < p.x + p.side; ++x) set(x, y, i);
    ++i;
  }
}

}  // namespace mixrig::render::cpu
