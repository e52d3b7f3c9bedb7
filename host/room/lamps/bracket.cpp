// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/bracket.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "hal/base/srgb.h"

namespace mixrig::lights {
namespace {

float luminance_of(Rgb8 c) {
  const auto linear = [](std::uint8_t v) { return linear_from_srgb(static_cast<float>(v) / 255); };
  return kRec709Red * linear(c.r) + kRec709Green * linear(c.g) + kRec709Blue * linear(c.b);
}

}  // namespace

BracketLight light_of_bracket(std::span<const BracketShot> shots) {
  if (shots.empty()) return {};
  std::vector<std::size_t> longest_first(shots.size());
  std::iota(longest_first.begin(), longest_first.end(), std::size_t{0});
  std::stable_sort(longest_first.begin(), longest_first.end(), [&](std::size_t a, std::size_t b) {
    return shots[a].exposure > shots[b].exposure;
  });
  const Size size = shots[0].picture.size;
  BracketLight light{Image<float>(size), Image<std::uint8_t>(size)};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      light.saturated.at(x, y) = 1;
      for (const std::size_t i : longest_first) {
        const Rgb8 c = shots[i].picture.row(y)[x];
        light.luminance.at(x, y) = luminance_of(c) / static_cast<float>(shots[i].exposure);
        if (std::max({c.r, c.g, c.b}) >= RegionOptions{}.saturation) continue;
        light.saturated.at(x, y) = 0;
        break;
      }
    }
  return light;
}

RegionLight light_of_region(const BracketLight& light, const BrightRegion& region,
                            const PixelOfRay& pixel) {
  RegionLight out;
  double solid_angle_sr = 0;
  for (const RegionRay& ray : region.rays) {
    const auto px = pixel(ray.direction);
    if (!px) continue;
    const auto x = static_cast<int>(std::lround(px->x())),
               y = static_cast<int>(std::lround(px->y()));
    if (x < 0 || y < 0 || x >= light.luminance.width() || y >= light.luminance.height()) continue;
    solid_angle_sr += ray.solid_angle_sr;
    out.radiance += ray.solid_angle_sr * static_cast<double>(light.luminance.at(x, y));
    out.saturated_share += ray.solid_angle_sr * light.saturated.at(x, y);
  }
  if (!(solid_angle_sr > 0)) return {};
  out.radiance /= solid_angle_sr, out.saturated_share /= solid_angle_sr;
  return out;
}

}  // namespace mixrig::lights
