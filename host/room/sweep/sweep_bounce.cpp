// SPDX-License-Identifier: Apache-2.0
#include "host/room/sweep/sweep_bounce.h"

#include <cmath>

#include "host/capture/depth/bounce_between.h"

namespace mixrig::session {
namespace {

/// At most so many views are searched for the reflectivity.
constexpr std::size_t kSearchedViews = 12;

/// Writes the values that are known.
void put_known(const Image<float>& from, Image<float>& to) {
  for (int y = 0; y < to.height(); ++y)
    for (int x = 0; x < to.width(); ++x)
      if (from.row(y)[x] > 0) to.row(y)[x] = from.row(y)[x];
}

}  // namespace

BouncedRoomLight take_out_bounced_light(const geometry::CameraModel& tof, double modulation_hz,
                                        std::vector<model::ScanView>& views, Crew& crew) {
  const depth::PixelRays rays(tof);
  std::vector<Image<float>> pictures_m, searched_m;
  const std::size_t step = (views.size() + kSearchedViews - 1) / kSearchedViews;
  for (std::size_t i = 0; i < views.size(); ++i) {
    rays.to_depth(pictures_m.emplace_back(views[i].distance_m));
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
  for (std::size_t i = 0; i < views.size() && out.removed; ++i) {
    rays.to_distance(pictures_m[i]);
    put_known(pictures_m[i], views[i].distance_m);
  }
  return out;
}

}  // namespace mixrig::session
