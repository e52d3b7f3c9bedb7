// SPDX-License-Identifier: Apache-2.0
#include "host/room/sweep/sweep_bounce.h"

#include <cmath>

#include "host/capture/depth/bounce_between.h"

namespace mixrig::session {
namespace {

/// At most so many views are searched for the reflectivity.
constexpr std::size_t kSearchedViews = 12;

Image<float> depth_of(const Image<float>& distance_m, const depth::PixelRays& rays) {
  Image<float> z_m(distance_m.size());
  for (int y = 0; y < z_m.height(); ++y)
    for (int x = 0; x < z_m.width(); ++x) {
      const auto ray = static_cast<float>(rays.at(x, y).norm());
      z_m.row(y)[x] = std::isfinite(ray) ? distance_m.row(y)[x] / ray : 0;
    }
  return z_m;
}

/// Writes the distances of known depths.
void set_distance(const Image<float>& z_m, const depth::PixelRays& rays, Image<float>& distance_m) {
  for (int y = 0; y < z_m.height(); ++y)
    for (int x = 0; x < z_m.width(); ++x)
      if (z_m.row(y)[x] > 0)
        distance_m.row(y)[x] = z_m.row(y)[x] * static_cast<float>(rays.at(x, y).norm());
}

}  // namespace

BouncedRoomLight take_out_bounced_light(const geometry::CameraModel& tof, double modulation_hz,
                                        std::vector<model::ScanView>& views, Crew& crew) {
  const depth::PixelRays rays(tof);
  std::vector<Image<float>> pictures_m, searched_m;
  const std::size_t step = (views.size() + kSearchedViews - 1) / kSearchedViews;
  for (std::size_t i = 0; i < views.size(); ++i) {
    pictures_m.push_back(depth_of(views[i].distance_m, rays));
    if (i % step == 0) searched_m.push_back(pictures_m.back());
  }
  BouncedRoomLight out;
  const depth::CornerError before = depth::corner_error(pictures_m, rays);
  out.corners = before.corners, out.before_mm = out.after_mm = 1e3 * before.error_m;
  const auto found = depth::find_reflectivity(searched_m, rays, modulation_hz);
  if (!found) return out;
  out.reflectivity = *found;
  crew.rows(static_cast<int>(views.size()), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i)
      depth::take_out_bounce({modulation_hz, *found}, rays,
                             pictures_m[static_cast<std::size_t>(i)]);
  });
  out.after_mm = 1e3 * depth::corner_error(pictures_m, rays).error_m;
  out.removed = std::abs(out.after_mm) < std::abs(out.before_mm);
  for (std::size_t i = 0; i < views.size() && out.removed; ++i)
    set_distance(pictures_m[i], rays, views[i].distance_m);
  return out;
}

}  // namespace mixrig::session
