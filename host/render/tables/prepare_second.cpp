// SPDX-License-Identifier: Apache-2.0
// Builds the tables of a second depth camera.
#include <cmath>
#include <limits>

#include "host/render/tables/prepare.h"

namespace mixrig::render {
namespace {

/// Factor of the focal length, at most 1, at which a picture without distortion holds all rays of
/// the camera.
double focal_that_holds(const geometry::Pinhole& camera, const Image<glm::vec2>& rays) {
  double share = 1;
  const auto hold = [&](double ray, double center_px, double last_px, double focal_px) {
    if (std::isnan(ray) || ray == 0) return;
    const double room_px = ray < 0 ? center_px : last_px - center_px;
    share = std::min(share, room_px / (std::abs(ray) * focal_px));
  };
  for (int y = 0; y < rays.height(); ++y)
    for (int x = 0; x < rays.width(); ++x) {
      hold(rays.row(y)[x].x, camera.cx_px, rays.width() - 1, camera.fx_px);
      hold(rays.row(y)[x].y, camera.cy_px, rays.height() - 1, camera.fy_px);
    }
  return std::max(share, 0.25);
}

/// `other_rays`: rays of the pixels of `other`.
AgreeTables agree_tables(const geometry::Pose& other_from_tof, const geometry::CameraModel& other,
                         const Image<glm::vec2>& other_rays) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const geometry::Pinhole& p = other.pinhole;
  const double share = focal_that_holds(p, other_rays);
  AgreeTables t;
  t.params.other_from_tof = glm::mat4(to_glm(other_from_tof.matrix()));
  t.params.other = {glm::vec2(share * p.fx_px, share * p.fy_px), glm::vec2(p.cx_px, p.cy_px)};
  t.params.px_per_px = static_cast<float>(1 / share);
  t.other_px.reset(p.size_px);
  for (int y = 0; y < t.other_px.height(); ++y)
    for (int x = 0; x < t.other_px.width(); ++x) {
      const auto px =
          other.project({(x - p.cx_px) / (share * p.fx_px), (y - p.cy_px) / (share * p.fy_px), 1});
      t.other_px.row(y)[x] = px ? glm::vec2(px->x(), px->y()) : glm::vec2(kNone);
    }
  return t;
}

}  // namespace

SecondTables make_second_tables(const CompositorSetup& setup) {
  const SecondTof& second = *setup.tof2;
  SecondTables t;
  t.tof.tof_size = second.model.size_px();
  t.tof.view_size = setup.view.size_px;
  t.tof.tof_ray = tof_rays(second.model);
  t.tof.correct.depth_is_distance = second.depth_is_distance;
  t.tof.correct.noise = noise_params(second.noise);
  t.tof.correct.bends_part = bends_part(second.model);
  t.tof.correct.stray_px_m2 = stray_px_m2(second.model);
  set_view(setup, t);
  const geometry::Pose second_from_first =
      geometry::inverse(second.target_from_tof) * setup.target_from_tof;
  t.first = agree_tables(second_from_first, second.model, t.tof.tof_ray);
  t.second = agree_tables(geometry::inverse(second_from_first), setup.tof, tof_rays(setup.tof));
  t.first.params.noise = t.second.params.other_noise = noise_params(setup.noise);
  t.second.params.noise = t.first.params.other_noise = noise_params(second.noise);
  return t;
}

void set_view(const CompositorSetup& setup, SecondTables& t) {
  const SecondTof& second = *setup.tof2;
  t.tof.warp.camera_from_tof = glm::mat4(to_glm(second.target_from_tof.matrix()));
  t.tof.warp.view = {glm::vec2(setup.view.fx_px, setup.view.fy_px),
                     glm::vec2(setup.view.cx_px, setup.view.cy_px)};
  t.tof.tof_footprint_px =
      static_cast<float>(std::max(1.0, setup.view.fx_px / second.model.pinhole.fx_px));
}

}  // namespace mixrig::render
