// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/room_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace mixrig::measure {
namespace {

constexpr int kEvenReach_px = 3;
constexpr float kEven = 0.1F;

bool is_even(ImageView<const float> truth, int x, int y) {
  const auto [width, height] = truth.size;
  if (y < kEvenReach_px || y + kEvenReach_px >= height) return false;
  const float here = truth.at(x, y);
  for (int dy = -kEvenReach_px; dy <= kEvenReach_px; ++dy)
    for (int dx = -kEvenReach_px; dx <= kEvenReach_px; ++dx)
      if (!(std::abs(truth.at((x + dx + width) % width, y + dy) - here) < kEven * here))
        return false;
  return true;
}

struct LightSample {
  double error = 0, weight = 0;
};

double weighted_quantile(std::vector<LightSample> samples, double q) {
  std::sort(samples.begin(), samples.end(),
            [](const LightSample& a, const LightSample& b) { return a.error < b.error; });
  double total = 0, sum = 0;
  for (const LightSample& s : samples) total += s.weight;
  for (const LightSample& s : samples)
    if ((sum += s.weight) >= q * total) return s.error;
  return 0;
}

struct LightClass {
  std::vector<LightSample> samples;
  std::size_t saturated = 0;

  LightError error() const {
    LightError e;
    e.places = samples.size() + saturated;
    if (e.places == 0) return e;
    e.saturated_pct = 100.0 * static_cast<double>(saturated) / static_cast<double>(e.places);
    std::vector<LightSample> sizes = samples;
    for (LightSample& s : sizes) s.error = std::abs(s.error);
    e.p50_pct = 100 * weighted_quantile(sizes, 0.5),
    e.p95_pct = 100 * weighted_quantile(sizes, 0.95);
    e.bias_pct = 100 * weighted_quantile(samples, 0.5);
    return e;
  }
};

}  // namespace

RoomLightErrors room_light_errors(ImageView<const float> model, ImageView<const float> saturated,
                                  ImageView<const float> truth) {
  std::array<LightClass, 3> classes;
  for (int y = 0; y < truth.size.height; ++y) {
    const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / truth.size.height);
    for (int x = 0; x < truth.size.width; ++x) {
      const float is = truth.at(x, y), found = model.at(x, y);
      if (found < 0 || is < 0.01F || !is_even(truth, x, y)) continue;
      LightClass& of = classes[is > 1 ? 0 : is > 0.25F ? 1 : 2];
      if (saturated.at(x, y) > 0)
        ++of.saturated;
      else
        of.samples.push_back({found / is - 1.0, std::cos(elevation)});
    }
  }
  return {classes[0].error(), classes[1].error(), classes[2].error()};
}

}  // namespace mixrig::measure
