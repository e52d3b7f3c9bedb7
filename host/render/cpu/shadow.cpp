// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/shadow.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixrig::render::cpu {
namespace {

void draw_casters(const FrameParams& params, std::size_t lamp, const SampleGrid& grid, int y0,
                  int y1, ShadowMap& map) {
  for (const Draw& draw : params.draws) {
    if (!draw.casts_shadow) continue;
    const glm::mat4& lamp_from_object =
        params.lamp_from_object[lamp][static_cast<std::size_t>(draw.object)];
    const MeshView& mesh = *draw.mesh;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const auto at = [&](std::size_t k) {
        return transform(lamp_from_object, mesh.positions_m[mesh.indices[i + k]]);
      };
      // Both faces cast: an open sheet has a shadow from either side.
      const auto triangle = set_up(at(0), at(1), at(2), grid, Facing::kBoth);
      if (!triangle) continue;
      for_each_sample(*triangle, y0, y1, [&](int x, int y, float w, const glm::vec3&) {
        map.row(y)[x] = std::max(map.row(y)[x], w);
      });
    }
  }
}

/// A disc of taps, coordinate by coordinate: loops over it become gathers.
template <int kTaps>
struct Disc {
  Disc() {
    for (int i = 0; i < kTaps; ++i) {
      const glm::vec2 tap = vogel_tap(i, kTaps);
      x[i] = tap.x, y[i] = tap.y;
    }
  }
  alignas(64) float x[kTaps], y[kTaps];
};

/// Nearest texels of a disc around `center`. The border of a map is empty, as is
/// everything outside.
template <int kTaps>
void read_disc(const ShadowMap& map, const Disc<kTaps>& disc, glm::vec2 center, float radius,
               float* values) {
  const float last = static_cast<float>(map.width() - 1);
  const float* texels = map.row(0);
  const int stride = static_cast<int>(map.stride());
#pragma omp simd
  for (int i = 0; i < kTaps; ++i) {
    const float x = std::min(std::max(center.x + radius * disc.x[i], 0.0F), last);
    const float y = std::min(std::max(center.y + radius * disc.y[i], 0.0F), last);
    values[i] = texels[static_cast<int>(y + 0.5F) * stride + static_cast<int>(x + 0.5F)];
  }
}

/// Mean lamp depth of what lies before `w` within `radius` texels; 0 for nothing.
float blocker_depth_m(const ShadowMap& map, glm::vec2 center, float radius, float w) {
  static const Disc<kBlockerTapCount> kDisc;
  alignas(64) std::array<float, kBlockerTapCount> values;
  read_disc(map, kDisc, center, radius, values.data());
  float sum = 0, count = 0;
#pragma omp simd reduction(+ : sum, count)
  for (int i = 0; i < kBlockerTapCount; ++i) {
    const bool before = values[static_cast<std::size_t>(i)] > w;
    sum += before ? 1 / values[static_cast<std::size_t>(i)] : 0;
    count += before ? 1.0F : 0.0F;
  }
  return count > 0 ? sum / count : 0;
}

/// Share of the taps within `radius` texels that nothing hides.
float lit_share(const ShadowMap& map, glm::vec2 center, float radius, float w) {
  static const Disc<kShadowTapCount> kDisc;
  alignas(64) std::array<float, kShadowTapCount> values;
  read_disc(map, kDisc, center, radius, values.data());
  float lit = 0;
#pragma omp simd reduction(+ : lit)
  for (int i = 0; i < kShadowTapCount; ++i)
    lit += values[static_cast<std::size_t>(i)] > w ? 0.0F : 1.0F;
  return lit / static_cast<float>(kShadowTapCount);
}

}  // namespace

void draw_shadow_maps(Crew& crew, const FrameParams& params, std::vector<ShadowMap>& maps) {
  constexpr int kGrain = 64;
  for (std::size_t i = 0; i < params.lamps.size(); ++i) {
    const LampParams& lamp = params.lamps[i];
    const int size = lamp.map_size_texel;
    maps[i].reset({size, size});
    const SampleGrid grid{
        glm::dvec2(lamp.map_focal_texel), glm::dvec2(lamp.map_center_texel), {0, 0, size, size}};
    crew.rows(size, kGrain,
              [&](int begin, int end) { draw_casters(params, i, grid, begin, end, maps[i]); });
  }
}

float visibility(const LampParams& lamp, const ShadowMap& map, const glm::vec3& position_m,
                 const glm::vec3& normal) {
  if (map.empty()) return 1;
  const glm::vec3 unmoved = transform(lamp.lamp_from_camera, position_m);
  if (!(unmoved.z > lamp.casters_near_m)) return 1;
  // A texel spans z / focal metres: kLiftTexels of them lift the point off its own surface.
  const float lift_m = kLiftTexels * unmoved.z / lamp.map_focal_texel;
  const glm::vec3 p = transform(lamp.lamp_from_camera, position_m + lift_m * normal);
  if (!(p.z > lamp.casters_near_m)) return 1;
  const glm::vec2 center = glm::vec2(p) * (lamp.map_focal_texel / p.z) + lamp.map_center_texel;
  const float w = 1 / p.z;
  const float reach = lamp.map_focal_texel * lamp.radius_m;
  const float search = reach * (1 / lamp.casters_near_m - w);
  const float last = static_cast<float>(lamp.map_size_texel - 1) + search;
  if (!(center.x > -search && center.y > -search && center.x < last && center.y < last)) return 1;
  const float blocker_m = blocker_depth_m(map, center, std::max(search, kLeastRadiusTexel), w);
  if (!(blocker_m > 0)) return 1;
  return lit_share(map, center, std::max(reach * (1 / blocker_m - w), kLeastRadiusTexel), w);
}

}  // namespace mixrig::render::cpu
