// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

constexpr int kGrain = 16;
constexpr std::uint16_t kLit = 65535;

/// Irradiance by an unhidden lamp, as CONVENTIONS.md has it.
glm::vec3 irradiance(const LampParams& lamp, const glm::vec3& position_m, const glm::vec3& normal) {
  const glm::vec3 to_lamp = lamp.position_m - position_m;
  const float distance2 = std::max(glm::dot(to_lamp, to_lamp), kLeastDistance2);
  const glm::vec3 direction = to_lamp / std::sqrt(distance2);
  const float receiver = std::max(0.0F, glm::dot(normal, direction));
  const float emitter =
      lamp.direction == glm::vec3(0) ? 1.0F : std::max(0.0F, -glm::dot(lamp.direction, direction));
  return lamp.intensity * (receiver * emitter / distance2);
}

/// Light with the virtual objects over light without, luminance.
float light_ratio(const LightInput& input, const glm::vec3& position_m, const glm::vec3& normal) {
  constexpr std::size_t kMost = 16;  // lamps whose shadows are looked up once
  std::array<float, kMost> seen{};
  const auto seen_of = [&](std::size_t i) {
    return visibility(input.frame.lamps[i], input.maps[i], position_m, normal);
  };
  bool shadowed = false;
  for (std::size_t i = 0; i < input.maps.size(); ++i) {
    const float share = seen_of(i);
    if (i < kMost) seen[i] = share;
    shadowed |= share < 1;
  }
  if (!shadowed) return 1;
  float with = luminance(input.frame.light.ambient), without = with;
  for (std::size_t i = 0; i < input.maps.size(); ++i) {
    const float light = luminance(irradiance(input.frame.lamps[i], position_m, normal));
    with += light * (i < kMost ? seen[i] : seen_of(i));
    without += light;
  }
  return without > 0 ? with / without : 1;
}

std::uint16_t to_fixed(float share) {
  return static_cast<std::uint16_t>(kLinearOne * std::clamp(share, 0.0F, 1.0F) + 0.5F);
}

glm::vec3 ray_of(const PinholeParams& view, int x, int y) {
  return {(static_cast<float>(x) - view.center_px.x) / view.focal_px.x,
          (static_cast<float>(y) - view.center_px.y) / view.focal_px.y, 1};
}

glm::vec3 unpack(PackedNormal n, const glm::vec3& ray) {
  const glm::vec3 normal(n.x, n.y, n.z);
  return normal == glm::vec3(0) ? -glm::normalize(ray) : glm::normalize(normal);
}

/// Centre of tile i along an axis, in pixels.
float tile_center(int i) {
  return static_cast<float>(kLightTilePx * i) + 0.5F * static_cast<float>(kLightTilePx - 1);
}

/// Mean inverse depth of the people in a tile; 0 without people.
float mean_w(const Image<float>& view_w, const Image<std::uint8_t>& matte, int tile_x, int tile_y) {
  float sum = 0, count = 0;
  const int x1 = std::min((tile_x + 1) * kLightTilePx, matte.width());
  const int y1 = std::min((tile_y + 1) * kLightTilePx, matte.height());
  for (int y = tile_y * kLightTilePx; y < y1; ++y)
    for (int x = tile_x * kLightTilePx; x < x1; ++x)
      if (matte.row(y)[x] >= kPersonByte && view_w.row(y)[x] > 0)
        sum += view_w.row(y)[x], count += 1;
  return count > 0 ? sum / count : 0;
}

/// A person's normal from the slope of w between tiles; towards the camera where it is not known.
glm::vec3 person_normal(const PinholeParams& view, const Image<float>& tile_w, int x, int y,
                        int reach, const glm::vec3& ray) {
  const auto w_at = [&](int i, int j) {
    const bool inside = i >= 0 && j >= 0 && i < tile_w.width() && j < tile_w.height();
    return inside ? tile_w.row(j)[i] : 0.0F;
  };
  const float left = w_at(x - reach, y), right = w_at(x + reach, y);
  const float above = w_at(x, y - reach), below = w_at(x, y + reach);
  if (!(left > 0 && right > 0 && above > 0 && below > 0)) return -glm::normalize(ray);
  const float per_px = 0.5F / static_cast<float>(reach * kLightTilePx);
  const float a = (right - left) * per_px * view.focal_px.x;
  const float b = (below - above) * per_px * view.focal_px.y;
  return -glm::normalize(glm::vec3(a, b, w_at(x, y) - a * ray.x - b * ray.y));
}

void light_tile(const LightInput& input, int x, int y, LightLayer& light) {
  const PinholeParams& view = input.tables.warp.view;
  const float w = light.tile_w.row(y)[x];
  if (!(w > 0)) return;
  const glm::vec2 px(tile_center(x), tile_center(y));
  const glm::vec3 ray((px - view.center_px) / view.focal_px, 1);
  const int reach = normal_reach_tiles(input.tables.tof_footprint_px);
  const glm::vec3 normal = person_normal(view, light.tile_w, x, y, reach, ray);
  light.tile_light.row(y)[x] = light_ratio(input, ray / w, normal);
}

/// Bilinear over the tiles that hold people; 1 where none does.
float tile_light_at(const LightLayer& light, int x, int y) {
  const float u = (static_cast<float>(x) - tile_center(0)) / kLightTilePx;
  const float v = (static_cast<float>(y) - tile_center(0)) / kLightTilePx;
  const int i0 = static_cast<int>(std::floor(u)), j0 = static_cast<int>(std::floor(v));
  float sum = 0, weights = 0;
  for (int j = std::max(j0, 0); j <= std::min(j0 + 1, light.tile_w.height() - 1); ++j)
    for (int i = std::max(i0, 0); i <= std::min(i0 + 1, light.tile_w.width() - 1); ++i) {
      if (!(light.tile_w.row(j)[i] > 0)) continue;
      const float weight =
          (1 - std::abs(u - static_cast<float>(i))) * (1 - std::abs(v - static_cast<float>(j)));
      sum += weight * light.tile_light.row(j)[i];
      weights += weight;
    }
  return weights > 0 ? sum / weights : 1;
}

}  // namespace

LightLayer::LightLayer(Size view_size) : background(view_size, kLit), visible(view_size, kLit) {
  const auto tiles = [](int px) { return (px + kLightTilePx - 1) / kLightTilePx; };
  tile_w.reset({tiles(view_size.width), tiles(view_size.height)});
  tile_light.reset(tile_w.size());
}

bool has_shadows(const FrameParams& frame) {
  return std::any_of(frame.lamps.begin(), frame.lamps.end(),
                     [](const LampParams& lamp) { return lamp.map_size_texel > 0; });
}

void light_background(Crew& crew, const LightInput& input, LightLayer& light) {
  const PinholeParams& view = input.tables.warp.view;
  crew.rows(light.background.height(), kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < light.background.width(); ++x) {
        const float z = input.tables.has_background ? input.background.depth_m.row(y)[x] : 0;
        std::uint16_t& out = light.background.row(y)[x];
        out = kLit;
        if (!(z > 0)) continue;
        const glm::vec3 ray = ray_of(view, x, y);
        const glm::vec3 normal = unpack(input.tables.background_normal.row(y)[x], ray);
        out = to_fixed(light_ratio(input, ray * z, normal));
      }
  });
}

void shade_virtual(Crew& crew, const LightInput& input, VirtualLayer& layer) {
  const PinholeParams& view = input.tables.warp.view;
  const Rect& rect = layer.rect;
  crew.rows(rect.y1 - rect.y0, kGrain, [&](int begin, int end) {
    for (int y = rect.y0 + begin; y < rect.y0 + end; ++y)
      for (int x = rect.x0; x < rect.x1; ++x) {
        if (layer.coverage.row(y)[x] == 0) continue;
        const glm::vec3 ray = ray_of(view, x, y);
        const glm::vec3 position_m = ray / layer.w.row(y)[x];
        const glm::vec3 normal = unpack(layer.normal.row(y)[x], ray);
        glm::vec3 light = input.frame.light.ambient;
        for (std::size_t i = 0; i < input.maps.size(); ++i) {
          const LampParams& lamp = input.frame.lamps[i];
          light += irradiance(lamp, position_m, normal) *
                   visibility(lamp, input.maps[i], position_m, normal);
        }
        Rgbx16& c = layer.color.row(y)[x];
        const glm::vec3 shaded =
            glm::vec3(c.r, c.g, c.b) * light * input.frame.light.exposure + 0.5F;
        const glm::vec3 clipped = glm::min(shaded, glm::vec3(kLinearOne));
        c = {static_cast<std::uint16_t>(clipped.r), static_cast<std::uint16_t>(clipped.g),
             static_cast<std::uint16_t>(clipped.b), 0};
      }
  });
}

void light_people(Crew& crew, const LightInput& input, const Image<float>& view_w,
                  const Image<std::uint8_t>& matte, LightLayer& light) {
  const int columns = light.tile_w.width(), rows = light.tile_w.height();
  crew.rows(rows, kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < columns; ++x) light.tile_w.row(y)[x] = mean_w(view_w, matte, x, y);
  });
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < columns; ++x) light_tile(input, x, y, light);
  });
  crew.rows(matte.height(), kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      std::copy_n(light.background.row(y), matte.width(), light.visible.row(y));
      for (int x = 0; x < matte.width(); ++x)
        if (matte.row(y)[x] >= kPersonByte)
          light.visible.row(y)[x] = to_fixed(tile_light_at(light, x, y));
    }
  });
}

}  // namespace mixrig::render::cpu
