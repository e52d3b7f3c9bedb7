// SPDX-License-Identifier: Apache-2.0
#include "host/room/click/click_grid.h"

#include <cmath>

namespace mixrig::model {

ClickGrid::ClickGrid(const ClickPicture& picture) : picture_(picture) {
  samples_.resize(size().area());
  for (int y = 0; y < size().height; ++y)
    for (int x = 0; x < size().width; ++x) samples_[index(x, y)] = sample(x, y);
}

void ClickGrid::scale_sigmas(double factor) {
  for (ClickSample& s : samples_) s.sigma_m *= factor;
}

ClickSample ClickGrid::sample(int x, int y) const {
  ClickSample s;
  const auto ray = picture_.tof->unproject({x, y});
  if (!ray) return s;
  s.ray = {ray->x(), ray->y(), 1};
  const double depth_m = picture_.depth_m.at(x, y);
  if (!(depth_m > 0) || !std::isfinite(depth_m)) return s;
  const double z_m = picture_.depth_is_distance ? depth_m / s.ray.norm() : depth_m;
  s.point_m = picture_.view_from_tof * (z_m * s.ray);
  s.sigma_m = picture_.noise.sigma_m(z_m);
  return s;
}

}  // namespace mixrig::model
