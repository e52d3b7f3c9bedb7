// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixrig::render::cpu {
namespace {

/// A filter of `radius_texel` around a place in a map, for each point.
struct FilterLanes {
  NumberLanes x_texel, y_texel, radius_texel;
  NumberLanes w;  ///< of the point in lamp axes, 1/m; infinite where it sees all of the lamp
};

/// Nearest texel of tap (x, y) of each filter. The border of a map is empty, as is everything
/// outside.
void read_tap(const Image<float>& map_w, const FilterLanes& filter, glm::vec2 tap, float* values) {
  const float last = static_cast<float>(map_w.width() - 1);
  const float* texels = map_w.row(0);
  const int stride = static_cast<int>(map_w.stride());
#pragma omp simd
  for (int i = 0; i < kLanes; ++i) {
    const float x_texel = filter.x_texel[i] + filter.radius_texel[i] * tap.x;
    const float y_texel = filter.y_texel[i] + filter.radius_texel[i] * tap.y;
    const float x = std::min(std::max(x_texel, 0.0F), last);
    const float y = std::min(std::max(y_texel, 0.0F), last);
    values[i] = texels[static_cast<int>(y + 0.5F) * stride + static_cast<int>(x + 0.5F)];
  }
}

/// Points into the lamp's map, with the radius in which casters can be. Whether any is in reach.
bool place(const LampParams& lamp, const VectorLanes& position_m, const VectorLanes& normal,
           FilterLanes& search) {
  const glm::mat4 m = lamp.lamp_from_camera;
  const float focal = lamp.map_focal_texel, center = lamp.map_center_texel;
  const float near_m = lamp.casters_near_m, near_w = 1 / near_m, reach = focal * lamp.radius_m;
  const float end = static_cast<float>(lamp.map_size_texel - 1);
  const float lift = kLiftTexels / focal;
  int in_reach = 0;
#pragma omp simd reduction(+ : in_reach)
  for (int i = 0; i < kLanes; ++i) {
    const float px = position_m.x[i], py = position_m.y[i], pz = position_m.z[i];
    const float unmoved_z = m[0].z * px + m[1].z * py + m[2].z * pz + m[3].z;
    // A texel spans z / focal metres: kLiftTexels of them lift the point off its own surface.
    const float lift_m = lift * unmoved_z;
    const float x = px + lift_m * normal.x[i], y = py + lift_m * normal.y[i],
                z = pz + lift_m * normal.z[i];
    const float lamp_x = m[0].x * x + m[1].x * y + m[2].x * z + m[3].x;
    const float lamp_y = m[0].y * x + m[1].y * y + m[2].y * z + m[3].y;
    const float lamp_z = m[0].z * x + m[1].z * y + m[2].z * z + m[3].z;
    const bool behind = (unmoved_z > near_m) & (lamp_z > near_m);
    const float w = 1 / (behind ? lamp_z : near_m);
    const float u = lamp_x * focal * w + center, v = lamp_y * focal * w + center;
    const float radius = reach * (near_w - w), last = end + radius;
    const bool inside = behind & (u > -radius) & (v > -radius) & (u < last) & (v < last);
    search.x_texel[i] = inside ? u : 0.0F;
    search.y_texel[i] = inside ? v : 0.0F;
    search.radius_texel[i] = inside ? std::max(radius, kLeastRadiusTexel) : 0.0F;
    search.w[i] = inside ? w : std::numeric_limits<float>::infinity();
    in_reach += inside;
  }
  return in_reach > 0;
}

/// The filter as wide as the penumbra of what lies before each point. Whether anything does.
bool find_blockers(const LampParams& lamp, const ShadowMap& map, FilterLanes& filter) {
  static const auto kTaps = vogel_disc<kBlockerTapCount>();
  NumberLanes sum{}, count{}, values;
  for (const glm::vec2 tap : kTaps) {
    read_tap(map.w, filter, tap, values.at);
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) {
      const bool before = values[i] > filter.w[i];
      sum[i] += before ? 1 / values[i] : 0.0F;
      count[i] += before ? 1.0F : 0.0F;
    }
  }
  const float reach = lamp.map_focal_texel * lamp.radius_m;
  int found = 0;
#pragma omp simd reduction(+ : found)
  for (int i = 0; i < kLanes; ++i) {
    const bool any = count[i] > 0;
    const float radius = reach * (count[i] / (any ? sum[i] : 1.0F) - filter.w[i]);
    filter.radius_texel[i] = any ? std::max(radius, kLeastRadiusTexel) : 0.0F;
    filter.w[i] = any ? filter.w[i] : std::numeric_limits<float>::infinity();
    found += any;
  }
  return found > 0;
}

}  // namespace

void visibility(const LampParams& lamp, const ShadowMap& map, const VectorLanes& position_m,
                const VectorLanes& normal, NumberLanes& seen) {
  static const auto kTaps = vogel_disc<kShadowTapCount>();
  std::fill_n(seen.at, kLanes, 1.0F);
  FilterLanes filter;
  if (map.empty() || !place(lamp, position_m, normal, filter) || !find_blockers(lamp, map, filter))
    return;
  NumberLanes hidden{}, values;
  for (const glm::vec2 tap : kTaps) {
    read_tap(map.w, filter, tap, values.at);
#pragma omp simd
    for (int i = 0; i < kLanes; ++i) hidden[i] += values[i] > filter.w[i] ? 1.0F : 0.0F;
  }
#pragma omp simd
  for (int i = 0; i < kLanes; ++i)
    seen[i] = (static_cast<float>(kShadowTapCount) - hidden[i]) / kShadowTapCount;
}

bool may_be_shadowed(const LampParams& lamp, const ShadowMap& map, const Corners& corners_m) {
  if (map.empty()) return false;
  constexpr float kMost = std::numeric_limits<float>::max();
  float x0 = kMost, y0 = kMost, x1 = -kMost, y1 = -kMost, z0 = kMost, z1 = -kMost;
  for (const glm::vec3& corner_m : corners_m) {
    const glm::vec3 p = transform(lamp.lamp_from_camera, corner_m);
    z0 = std::min(z0, p.z), z1 = std::max(z1, p.z);
    const float x = p.x / p.z, y = p.y / p.z;
    x0 = std::min(x0, x), x1 = std::max(x1, x);
    y0 = std::min(y0, y), y1 = std::max(y1, y);
  }
  if (!(z1 > lamp.casters_near_m)) return false;
  if (!(z0 > static_cast<float>(kNearestM))) return true;  // reaches behind the lamp
  // Lifting moves a point by `lift` of its depth in any direction.
  const float focal = lamp.map_focal_texel, lift = kLiftTexels / focal;
  if (!(lift < 0.5F)) return true;
  const float slope = std::max(std::max(-x0, x1), std::max(-y0, y1));
  const float moved_texel = kLiftTexels * (1 + std::max(slope, 0.0F)) / (1 - lift);
  const float w = 1 / (z1 * (1 + lift)), reach = focal * lamp.radius_m;
  // Nothing that is farther than the point hides it; 0.1 % for rounding.
  const auto largest_within = [&](float blocker_w) {
    const float margin =
        moved_texel + std::max(reach * (blocker_w - w), kLeastRadiusTexel) * 1.001F + 1;
    const float center = lamp.map_center_texel;
    return 1.001F * largest_w(map, focal * x0 + center - margin, focal * y0 + center - margin,
                              focal * x1 + center + margin, focal * y1 + center + margin);
  };
  // Casters are searched as far as the nearest one could hide the point; the filter is no wider
  // than the nearest that is found allows.
  const float nearest_w = largest_within(1 / lamp.casters_near_m);
  return nearest_w > w && largest_within(nearest_w) > w;
}

}  // namespace mixrig::render::cpu
