// SPDX-License-Identifier: Apache-2.0
// The composite of the truth through a thin lens: the mean of pictures from points of its aperture.
#include <cmath>
#include <numbers>

#include "studio/srgb.h"
#include "studio/studio_state.h"

namespace mixrig::studio {
namespace {

constexpr int kLensPoints = 97, kLensBand = 4;

/// Point `i` of kLensPoints on the unit disc, evenly spread along a spiral.
Eigen::Vector2d lens_point(int i) {
  const double radius = std::sqrt((i + 0.5) / kLensPoints);
  const double angle = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace

/// Averages pictures of pinholes at points of the aperture, each moved so that surfaces at the
/// focus stay in place.
void Studio::State::draw_through_lens(const CameraPlace& place, Image<Rgb8>& composite) {
  const Size size = options.size_px;
  const Rect all{0, 0, size.width, size.height};
  Image<Rgbf> sum(size);
  SceneSurfels seen;
  for (int i = 0; i < kLensPoints; ++i) {
    const Eigen::Vector2d at_m = 0.5 * options.lens.aperture_m * lens_point(i);
    Optics optics = info.view;
    optics.cx_px += optics.fx_px * at_m.x() / options.lens.focus_m;
    optics.cy_px += optics.fy_px * at_m.y() / options.lens.focus_m;
    CameraPlace from = place;
    from.world_from_target.translation_m +=
        place.world_from_target.rotation * Eigen::Vector3d(at_m.x(), at_m.y(), 0);
    const RayGrid grid(optics);
    const CameraRays rays = camera_rays(grid, from.world_from_target);
    seen.room.build(room, materials, rays, all, crew);
    light_surfels(seen.room, lamps, casters, true, false, crew);
    seen.object.build(object.scene, materials, rays,
                      covered_by(object.scene.mesh(), optics, from.world_from_target), crew);
    light_surfels(seen.object, lamps, casters, true, false, crew);
    trace_person(from, grid, optics, seen, true);
    crew.rows(size.height, kLensBand, [&](int begin, int end) {
      for (int y = begin; y < end; ++y)
        for (int x = 0; x < size.width; ++x) {
          const Vec3 c = compose_pixel(seen, x, y, lamps, ambient, casters, true).mixed;
          Rgbf& to = sum.at(x, y);
          to = {to.r + c[0], to.g + c[1], to.b + c[2]};
        }
    });
  }
  const float share = static_cast<float>(info.light.exposure) / kLensPoints;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Rgbf& c = sum.at(x, y);
      composite.at(x, y) = srgb_from_linear(Vec3(share * c.r, share * c.g, share * c.b));
    }
}

}  // namespace mixrig::studio
