// SPDX-License-Identifier: Apache-2.0
// Pass light: computes the light of people and mixes it with that of the room.
#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/light/light_parts.h"

namespace mixrig::render::cpu {
namespace {

constexpr int kPeopleGrain = 16;

/// Centre of tile i along an axis, in pixels.
float tile_center(int i) {
  return static_cast<float>(kLightTilePx * i) + 0.5F * static_cast<float>(kLightTilePx - 1);
}

/// Mean inverse depth of the people in a tile; 0 without people.
float mean_w(const Image<float>& view_w, const Image<std::uint8_t>& matte, int tile_x, int tile_y) {
  float sum = 0, count = 0;
  const int x1 = std::min((tile_x + 1) * kLightTilePx, matte.width());
  const int y1 = std::min((tile_y + 1) * kLightTilePx, matte.height());
  static_assert(kLightTilePx == sizeof(std::uint32_t));
  for (int y = tile_y * kLightTilePx; y < y1; ++y) {
    const int x0 = tile_x * kLightTilePx;
    if (x1 - x0 == kLightTilePx && no_people<std::uint32_t>(matte.row(y) + x0)) continue;
    for (int x = x0; x < x1; ++x)
      if (matte.row(y)[x] >= kPersonByte && view_w.row(y)[x] > 0)
        sum += view_w.row(y)[x], count += 1;
  }
  return count > 0 ? sum / count : 0;
}

/// A person's normal from the slope of w between tiles; towards the camera if unknown.
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

/// Computes the light of a row of people's tiles.
void light_tiles_of_people(const LightInput& input, int y, LightLayer& light) {
  const PinholeParams& view = input.tables.warp.view;
  const int reach = normal_reach_tiles(input.tables.tof_footprint_px);
  const int columns = light.tile_w.width();
  const float* tile_w = light.tile_w.row(y);
  SurfaceLanes at;
  std::array<int, kLanes> tiles;
  int count = 0;
  const auto find = [&] {
    for (int i = count; i < kLanes; ++i) at.set(i, {0, 0, 1}, {0, 0, -1});
    const FloatLanes ratio = light_ratio(input.frame, input.maps, kAllLamps, true, at);
    for (int i = 0; i < count; ++i)
      light.tile_light.row(y)[tiles[static_cast<std::size_t>(i)]] = ratio[i];
    count = 0;
  };
  for (int x = 0; x < columns; ++x) {
    if (!(tile_w[x] > 0)) continue;
    const glm::vec2 px(tile_center(x), tile_center(y));
    const glm::vec3 ray((px - view.center_px) / view.focal_px, 1);
    at.set(count, ray / tile_w[x], person_normal(view, light.tile_w, x, y, reach, ray));
    tiles[static_cast<std::size_t>(count)] = x;
    if (++count == kLanes) find();
  }
  if (count > 0) find();
}

/// Bilinear over the tiles that contain people; 1 if none does.
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
void light_people(Crew& crew, const LightInput& input, const Image<float>& view_w,
                  const Image<std::uint8_t>& matte, LightLayer& light) {
  const int columns = light.tile_w.width(), rows = light.tile_w.height();
  crew.rows(rows, kPeopleGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < columns; ++x) light.tile_w.row(y)[x] = mean_w(view_w, matte, x, y);
  });
  crew.rows(rows, 4, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) light_tiles_of_people(input, y, light);
  });
  crew.rows(matte.height(), kPeopleGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      const std::uint8_t* matte_row = matte.row(y);
      std::uint16_t* visible = light.visible.row(y);
      for (int x = 0; x < matte.width(); ++x) {
        constexpr int kWord = sizeof(std::uint64_t);
        while (x + kWord <= matte.width() && load<std::uint64_t>(matte_row + x) == 0) x += kWord;
        if (x >= matte.width() || matte_row[x] == 0) continue;
        const float share = static_cast<float>(matte_row[x]) / 255;
        const float behind = static_cast<float>(visible[x]) / kLinearOne;
        visible[x] = light_to_fixed(behind + share * (tile_light_at(light, x, y) - behind));
      }
    }
  });
}

}  // namespace mixrig::render::cpu
