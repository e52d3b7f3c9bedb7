// SPDX-License-Identifier: Apache-2.0
// The lens of a frame: its view, and the plate pixel of each view pixel.
#include "host/math/geometry/lens_table.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {

geometry::Pinhole view_through(const CompositorSetup& setup, const geometry::Pinhole& target) {
  const geometry::Pinhole &view = setup.view, &first = setup.target.pinhole;
  const double view_per_plate_x = static_cast<double>(view.size_px.width) / first.size_px.width;
  const double view_per_plate_y = static_cast<double>(view.size_px.height) / first.size_px.height;
  return {view.size_px, view.fx_px * (target.fx_px / first.fx_px),
          view.fy_px * (target.fy_px / first.fy_px),
          view.cx_px + view_per_plate_x * (target.cx_px - first.cx_px),
          view.cy_px + view_per_plate_y * (target.cy_px - first.cy_px)};
}

void plate_row(const geometry::CameraModel& target, const geometry::Pinhole& view, int y,
               glm::vec2* out) {
  // Projects (x, y, 1) as CameraModel::project() does, without branches and with local copies, so
  // that the loop vectorises.
  const geometry::Lens::Coefficients k = target.lens.coefficients();
  const geometry::Pinhole plate = target.pinhole;
  const double ray_y = (y - view.cy_px) / view.fy_px, domain_r2 = target.lens.domain_r2();
  const double per_px = 1 / view.fx_px, first_x = view.cx_px, ray_y2 = ray_y * ray_y;
  const int width = view.size_px.width;
  float* const to = &out[0].x;
  for (int x = 0; x < width; ++x) {
    const double ray_x = (x - first_x) * per_px;
    const double r2 = ray_x * ray_x + ray_y2, xy = ray_x * ray_y;
    const double gain =
        (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
    const double u = ray_x * gain + 2 * k[2] * xy + k[3] * (r2 + 2 * ray_x * ray_x);
    const double v = ray_y * gain + k[2] * (r2 + 2 * ray_y2) + 2 * k[3] * xy;
    // Where the lens has no pixel, the plate's corner (0, 0) is used.
    const double plate_x = plate.fx_px * u + plate.cx_px, plate_y = plate.fy_px * v + plate.cy_px;
    to[2 * x] = static_cast<float>(r2 <= domain_r2 ? plate_x : 0.0);
    to[2 * x + 1] = static_cast<float>(r2 <= domain_r2 ? plate_y : 0.0);
  }
}

LensFollower::LensFollower(const CompositorSetup& setup)
    : target_(setup.target),
      view_(setup.view),
      target_from_tof_(setup.target_from_tof),
      target_from_tof2_(setup.tof2 ? setup.tof2->target_from_tof : geometry::Pose{}),
      pinhole_(setup.target.pinhole),
      distortion_(setup.target.lens.coefficients()) {}

bool LensFollower::follow(const std::optional<geometry::LensState>& lens, CompositorSetup& setup,
                          Tables& tables) {
  const geometry::CameraModel& target = lens ? lens->camera : target_;
  const double pupil_shift_m = lens ? lens->pupil_shift_m : 0;
  if (target.pinhole == pinhole_ && target.lens.coefficients() == distortion_ &&
      pupil_shift_m == pupil_shift_m_)
    return false;
  pinhole_ = target.pinhole, distortion_ = target.lens.coefficients();
  pupil_shift_m_ = pupil_shift_m;
  setup.target = target_, setup.view = view_;
  setup.view = view_through(setup, target.pinhole);
  setup.target = target;
  setup.target_from_tof = geometry::at_pupil({}, -pupil_shift_m) * target_from_tof_;
  if (setup.tof2)
    setup.tof2->target_from_tof = geometry::at_pupil({}, -pupil_shift_m) * target_from_tof2_;
  set_view(setup, tables);
  return true;
}

geometry::Pose LensFollower::world_from_pupil(const geometry::Pose& world_from_target) const {
  return pupil_shift_m_ == 0 ? world_from_target
                             : geometry::at_pupil(world_from_target, pupil_shift_m_);
}

}  // namespace mixrig::render
