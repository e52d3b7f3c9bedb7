// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixrig::render::cpu {
namespace {

constexpr float kLitAll_w = std::numeric_limits<float>::max();

/// A filter of `radius_texel` around a place in a map, for each point.
struct FilterLanes {
  FloatLanes x_texel, y_texel, radius_texel;
  FloatLanes w;  ///< of the point in lamp axes, 1/m; kLitAll_w where it sees all of the lamp
};

/// Reads the taps of filters.
class TapReader {
 public:
  explicit TapReader(const Image<float>& map_w)
      : texels_(map_w.row(0)),
        stride_(static_cast<std::int32_t>(map_w.stride())),
        last_(FloatLanes{} + static_cast<float>(map_w.width() - 1)) {}
  /// Nearest texel of tap (x, y) of each filter. The border of a map is empty, as is everything
  /// outside.
  FloatLanes read(const FilterLanes& filter, glm::vec2 tap) const {
    const FloatLanes x = filter.x_texel + filter.radius_texel * tap.x;
    const FloatLanes y = filter.y_texel + filter.radius_texel * tap.y;
    return gather(texels_, texel(y) * stride_ + texel(x));
  }

 private:
  IntLanes texel(FloatLanes at) const { return truncate(min(max(at, FloatLanes{}), last_) + 0.5F); }

  const float* texels_;
  std::int32_t stride_;
  FloatLanes last_;
};

/// Coordinate `axis` of each point in the lamp's axes.
FloatLanes in_lamp(const glm::mat4& m, int axis, FloatLanes x, FloatLanes y, FloatLanes z) {
  return x * m[0][axis] + y * m[1][axis] + z * m[2][axis] + m[3][axis];
}

/// Points into the lamp's map, with the radius in which casters can be.
FilterLanes place(const LampParams& lamp, const VectorLanes& p, const VectorLanes& normal) {
  const glm::mat4& m = lamp.lamp_from_camera;
  const float focal = lamp.map_focal_texel, near_m = lamp.casters_near_m;
  const FloatLanes unmoved_z = in_lamp(m, 2, p.x, p.y, p.z);
  // A texel spans z / focal metres: kLiftTexels of them lift the point off its own surface.
  const FloatLanes lift_m = unmoved_z * (kLiftTexels / focal);
  const FloatLanes x = p.x + lift_m * normal.x, y = p.y + lift_m * normal.y,
                   z = p.z + lift_m * normal.z;
  const FloatLanes lamp_z = in_lamp(m, 2, x, y, z);
  const IntLanes behind = (unmoved_z > near_m) & (lamp_z > near_m);
  const FloatLanes w = 1 / (behind ? lamp_z : FloatLanes{} + near_m);
  const FloatLanes u = in_lamp(m, 0, x, y, z) * w * focal + lamp.map_center_texel;
  const FloatLanes v = in_lamp(m, 1, x, y, z) * w * focal + lamp.map_center_texel;
  const FloatLanes radius = (1 / near_m - w) * (focal * lamp.radius_m);
  const FloatLanes last = radius + static_cast<float>(lamp.map_size_texel - 1);
  const IntLanes inside = behind & (u > -radius) & (v > -radius) & (u < last) & (v < last);
  return {inside ? u : FloatLanes{}, inside ? v : FloatLanes{},
          inside ? max(radius, FloatLanes{} + kLeastRadiusTexel) : FloatLanes{},
          inside ? w : FloatLanes{} + kLitAll_w};
}

/// Makes the filters as wide as the penumbra of what lies before each point.
void find_blockers(const LampParams& lamp, const TapReader& reader, FilterLanes& filter) {
  static const auto kTaps = vogel_disc<kBlockerTapCount>();
  FloatLanes sum_m{}, count{};
  for (const glm::vec2 tap : kTaps) {
    const FloatLanes w = reader.read(filter, tap);
    const IntLanes before = w > filter.w;
    sum_m += before ? 1 / w : FloatLanes{};
    count -= to_float(before);  // true is -1
  }
  const IntLanes found = count > 0;
  const FloatLanes blocker_w = count / (found ? sum_m : FloatLanes{} + 1.0F);
  const FloatLanes radius = (blocker_w - filter.w) * (lamp.map_focal_texel * lamp.radius_m);
  filter.radius_texel = max(found ? radius : FloatLanes{}, FloatLanes{} + kLeastRadiusTexel);
  filter.w = found ? filter.w : FloatLanes{} + kLitAll_w;
}

}  // namespace

FloatLanes visibility(const LampParams& lamp, const ShadowMap& map, const VectorLanes& position_m,
                      const VectorLanes& normal) {
  static const auto kTaps = vogel_disc<kShadowTapCount>();
  const FloatLanes all = FloatLanes{} + 1.0F;
  if (map.empty()) return all;
  FilterLanes filter = place(lamp, position_m, normal);
  if (!any(filter.w < kLitAll_w)) return all;
  const TapReader reader(map.w);
  find_blockers(lamp, reader, filter);
  if (!any(filter.w < kLitAll_w)) return all;
  FloatLanes lit{};
  for (const glm::vec2 tap : kTaps) lit -= to_float(reader.read(filter, tap) <= filter.w);
  return lit / static_cast<float>(kShadowTapCount);
}

bool may_be_shadowed(const LampParams& lamp, const ShadowMap& map, const Corners& corners_m) {
  if (map.empty()) return false;
  float x0 = kLitAll_w, y0 = kLitAll_w, x1 = -kLitAll_w, y1 = -kLitAll_w, z0 = kLitAll_w,
        z1 = -kLitAll_w;
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
