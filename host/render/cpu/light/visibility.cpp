// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixrig::render::cpu {
namespace {

constexpr float kLitAll_w = std::numeric_limits<float>::max();

/// For each point, a filter in the map: tap (s, t) of the lamp's panel lies radius_texel * (s
/// panel_u + t panel_v) from the point's texel.
struct FilterLanes {
  FloatLanes x_texel, y_texel, radius_texel;
  /// Panel axes as the point sees them along its ray.
  FloatLanes panel_ux, panel_uy, panel_vx, panel_vy;
  FloatLanes w;  ///< of the point in lamp axes, 1/m; kLitAll_w if it sees the whole lamp
  /// Change of w on the point's own surface, 1/m a texel of panel_u and panel_v.
  FloatLanes slope_u, slope_v;
  /// Inverse depth above which a tap hides the point: the larger of the point's own and that of its
  /// surface's plane at the tap.
  FloatLanes least_w(glm::vec2 tap) const {
    return w + max(radius_texel * (tap.x * slope_u + tap.y * slope_v), FloatLanes{});
  }
};

/// Reads the taps of filters from a map.
class TapReader {
 public:
  explicit TapReader(const Image<float>& map_w)
      : texels_(map_w.row(0)),
        stride_(static_cast<std::int32_t>(map_w.stride())),
        last_(FloatLanes{} + static_cast<float>(map_w.width() - 1)) {}
  /// Nearest texel at a tap of each filter. The border of a map, and everything outside, is empty.
  FloatLanes read(const FilterLanes& f, glm::vec2 tap) const {
    const FloatLanes x = f.x_texel + f.radius_texel * (tap.x * f.panel_ux + tap.y * f.panel_vx);
    const FloatLanes y = f.y_texel + f.radius_texel * (tap.x * f.panel_uy + tap.y * f.panel_vy);
    return gather(texels_, texel(y) * stride_ + texel(x));
  }

 private:
  IntLanes texel(FloatLanes at) const { return truncate(min(max(at, FloatLanes{}), last_) + 0.5F); }

  const float* texels_;
  std::int32_t stride_;
  FloatLanes last_;
};

/// Coordinate `axis` of each point in lamp axes.
FloatLanes in_lamp(const glm::mat4& m, int axis, FloatLanes x, FloatLanes y, FloatLanes z) {
  return x * m[0][axis] + y * m[1][axis] + z * m[2][axis] + m[3][axis];
}

/// Sets the slopes of the surfaces' planes: w is affine over a plane in the map.
void find_slopes(const LampParams& lamp, const VectorLanes& normal, FloatLanes ray_x,
                 FloatLanes ray_y, FilterLanes& filter) {
  const glm::mat4& m = lamp.lamp_from_camera;
  const auto along = [&](int axis) {
    return normal.x * m[0][axis] + normal.y * m[1][axis] + normal.z * m[2][axis];
  };
  const FloatLanes x = along(0), y = along(1), toward = ray_x * x + ray_y * y + along(2);
  const FloatLanes scale =
      filter.w / (lamp.map_focal_texel * min(toward, FloatLanes{} + kSteepestCosine));
  filter.slope_u = (x * filter.panel_ux + y * filter.panel_uy) * scale;
  filter.slope_v = (x * filter.panel_vx + y * filter.panel_vy) * scale;
}

/// Projects points into the lamp's map, with the largest radius in which casters can be.
FilterLanes place(const LampParams& lamp, const VectorLanes& p, const VectorLanes& normal,
                  IntLanes wanted) {
  const glm::mat4& m = lamp.lamp_from_camera;
  const float focal = lamp.map_focal_texel, near_m = lamp.casters_near_m;
  const FloatLanes unmoved_z = in_lamp(m, 2, p.x, p.y, p.z);
  // A texel spans z / focal metres; lifting by kLiftTexels moves the point off its own surface.
  const FloatLanes lift_m = unmoved_z * (kLiftTexels / focal);
  const FloatLanes x = p.x + lift_m * normal.x, y = p.y + lift_m * normal.y,
                   z = p.z + lift_m * normal.z;
  const FloatLanes lamp_z = in_lamp(m, 2, x, y, z);
  const IntLanes behind = wanted & (unmoved_z > near_m) & (lamp_z > near_m);
  const FloatLanes w = 1 / (behind ? lamp_z : FloatLanes{} + near_m);
  const FloatLanes ray_x = in_lamp(m, 0, x, y, z) * w, ray_y = in_lamp(m, 1, x, y, z) * w;
  const FloatLanes u = ray_x * focal + lamp.map_center_texel;
  const FloatLanes v = ray_y * focal + lamp.map_center_texel;
  const FloatLanes radius =
      max((1 / near_m - w) * (focal * lamp.radius_m), FloatLanes{} + kLeastRadiusTexel);
  // A point of the panel that is nearer than its centre appears shifted aside.
  FilterLanes filter{};
  filter.panel_ux = lamp.panel_u.x - lamp.panel_u.z * ray_x;
  filter.panel_uy = lamp.panel_u.y - lamp.panel_u.z * ray_y;
  filter.panel_vx = lamp.panel_v.x - lamp.panel_v.z * ray_x;
  filter.panel_vy = lamp.panel_v.y - lamp.panel_v.z * ray_y;
  const FloatLanes reach_x = radius * (abs(filter.panel_ux) + abs(filter.panel_vx));
  const FloatLanes reach_y = radius * (abs(filter.panel_uy) + abs(filter.panel_vy));
  const float last = static_cast<float>(lamp.map_size_texel - 1);
  const IntLanes inside =
      behind & (u > -reach_x) & (v > -reach_y) & (u < last + reach_x) & (v < last + reach_y);
  filter.x_texel = inside ? u : FloatLanes{};
  filter.y_texel = inside ? v : FloatLanes{};
  filter.radius_texel = inside ? radius : FloatLanes{};
  filter.w = w;
  find_slopes(lamp, normal, ray_x, ray_y, filter);
  filter.w = inside ? w : FloatLanes{} + kLitAll_w;
  return filter;
}

/// Sets the radius of each filter to the width of the penumbra of what lies before the point.
template <int kCount>
void find_blockers(const LampParams& lamp, const TapReader& reader, FilterLanes& filter) {
  static const auto kTaps = panel_taps<kCount>();
  FloatLanes sum_m{}, count{};
  for (const glm::vec2 tap : kTaps) {
    const FloatLanes w = reader.read(filter, tap);
    const IntLanes before = w > filter.least_w(tap);
    sum_m += before ? inverse(w) : FloatLanes{};
    count -= to_float(before);  // true is -1
  }
  const IntLanes found = count > 0;
  const FloatLanes blocker_w = count / (found ? sum_m : FloatLanes{} + 1.0F);
  const FloatLanes radius = (blocker_w - filter.w) * (lamp.map_focal_texel * lamp.radius_m);
  filter.radius_texel = max(found ? radius : FloatLanes{}, FloatLanes{} + kLeastRadiusTexel);
  filter.w = found ? filter.w : FloatLanes{} + kLitAll_w;
}

/// Whether any texel within `radius_texel` of a filter's centre may be nearer than its point.
bool may_find(const ShadowMap& map, const FilterLanes& f, FloatLanes radius_texel, float& most_w) {
  const IntLanes doubt = f.w < kLitAll_w;
  const FloatLanes far = FloatLanes{} + kLitAll_w;
  const FloatLanes reach_x = radius_texel * (abs(f.panel_ux) + abs(f.panel_vx)) + 1.0F;
  const FloatLanes reach_y = radius_texel * (abs(f.panel_uy) + abs(f.panel_vy)) + 1.0F;
  const float x0 = least_of(doubt ? f.x_texel - reach_x : far);
  const float x1 = -least_of(doubt ? -f.x_texel - reach_x : far);
  const float y0 = least_of(doubt ? f.y_texel - reach_y : far);
  const float y1 = -least_of(doubt ? -f.y_texel - reach_y : far);
  most_w = largest_w(map, x0, y0, x1, y1);
  return most_w > least_of(f.w);
}

/// Whether part of the lamp may be hidden from a point: casters are searched as far as the nearest
/// caster could hide it; then the filter is limited by the nearest one found.
bool may_be_hidden(const LampParams& lamp, const ShadowMap& map, const FilterLanes& filter) {
  float most_w = 0;
  if (!may_find(map, filter, filter.radius_texel, most_w)) return false;
  const FloatLanes widest = max((most_w - filter.w) * (lamp.map_focal_texel * lamp.radius_m),
                                FloatLanes{} + kLeastRadiusTexel);
  return may_find(map, filter, min(widest, filter.radius_texel), most_w);
}

/// Visible share of the lamp through the filters of place().
template <int kBlockers, int kCount>
FloatLanes seen_by(const LampParams& lamp, const ShadowMap& map, FilterLanes& filter) {
  static const auto kTaps = panel_taps<kCount>();
  const TapReader reader(map.w);
  find_blockers<kBlockers>(lamp, reader, filter);
  if (!any(filter.w < kLitAll_w)) return FloatLanes{} + 1.0F;
  FloatLanes lit{};
  for (const glm::vec2 tap : kTaps)
    lit -= to_float(reader.read(filter, tap) <= filter.least_w(tap));
  return lit / static_cast<float>(kCount);
}
FloatLanes seen_by(const LampParams& lamp, const ShadowMap& map, FilterLanes& filter) {
  return lamp.is_part ? seen_by<kPartBlockerTapCount, kPartShadowTapCount>(lamp, map, filter)
                      : seen_by<kBlockerTapCount, kShadowTapCount>(lamp, map, filter);
}

}  // namespace

FloatLanes visibility_of_caster(const LampParams& lamp, const ShadowMap& map,
                                const VectorLanes& position_m, const VectorLanes& normal,
                                IntLanes wanted) {
  if (map.empty()) return FloatLanes{} + 1.0F;
  FilterLanes filter = place(lamp, position_m, normal, wanted);
  return any(filter.w < kLitAll_w) ? seen_by(lamp, map, filter) : FloatLanes{} + 1.0F;
}

FloatLanes visibility(const LampParams& lamp, const ShadowMap& map, const VectorLanes& position_m,
                      const VectorLanes& normal, IntLanes wanted) {
  if (map.empty()) return FloatLanes{} + 1.0F;
  FilterLanes filter = place(lamp, position_m, normal, wanted);
  const bool some = any(filter.w < kLitAll_w) && may_be_hidden(lamp, map, filter);
  return some ? seen_by(lamp, map, filter) : FloatLanes{} + 1.0F;
}

bool may_be_shadowed(const LampParams& lamp, const ShadowMap& map, const Corners& corners) {
  if (map.empty()) return false;
  const glm::mat4& m = lamp.lamp_from_camera;
  const auto along = [&](int axis, const Corners::Face& f) {
    return f.x_m * m[0][axis] + f.y_m * m[1][axis] + f.z_m * m[2][axis] + m[3][axis];
  };
  const auto& [near_face, far_face] = corners.faces;
  const F4 near_z = along(2, near_face), far_z = along(2, far_face);
  const float z1 = -least_of4(min4(-near_z, -far_z));
  if (!(z1 > lamp.casters_near_m)) return false;
  if (!(least_of4(min4(near_z, far_z)) > static_cast<float>(kNearestM)))
    return true;  // the space reaches behind the lamp
  const F4 near_x = along(0, near_face) / near_z, far_x = along(0, far_face) / far_z;
  const F4 near_y = along(1, near_face) / near_z, far_y = along(1, far_face) / far_z;
  const float x0 = least_of4(min4(near_x, far_x)), x1 = -least_of4(min4(-near_x, -far_x));
  const float y0 = least_of4(min4(near_y, far_y)), y1 = -least_of4(min4(-near_y, -far_y));
  // Lifting moves a point by up to `lift` of its depth in any direction.
  const float focal = lamp.map_focal_texel, lift = kLiftTexels / focal;
  if (!(lift < 0.5F)) return true;
  const float slope = std::max(std::max(-x0, x1), std::max(-y0, y1));
  const float moved_texel = kLiftTexels * (1 + std::max(slope, 0.0F)) / (1 - lift);
  const float w = 1 / (z1 * (1 + lift)), reach = focal * lamp.radius_m;
  // Largest extent of the panel along an axis of the map, in radii.
  const float steep = (slope + lift) / (1 - lift);
  const glm::vec3 panel = glm::abs(lamp.panel_u) + glm::abs(lamp.panel_v);
  const float extent = std::max(panel.x, panel.y) + panel.z * steep;
  // What is farther than the point does not hide it; 0.1 % covers rounding.
  const auto largest_within = [&](float blocker_w) {
    const float margin =
        moved_texel + std::max(reach * (blocker_w - w), kLeastRadiusTexel) * extent * 1.001F + 1;
    const float center = lamp.map_center_texel;
    return 1.001F * largest_w(map, focal * x0 + center - margin, focal * y0 + center - margin,
                              focal * x1 + center + margin, focal * y1 + center + margin);
  };
  // Casters are searched as far as the nearest caster could hide the point; then the filter is
  // limited by the nearest one found.
  const float nearest_w = largest_within(1 / lamp.casters_near_m);
  return nearest_w > w && largest_within(nearest_w) > w;
}

}  // namespace mixrig::render::cpu
