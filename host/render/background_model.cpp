// SPDX-License-Identifier: Apache-2.0
#include "host/render/background_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/base/order_statistics.h"

namespace mixrig::render {
namespace {

constexpr int kMostStepPx = 16;
/// Of one measurement's: a sample is the median of several model pixels.
constexpr float kMedianSigma = 0.5F;

/// Median of the known depths of a cell, if it knows at least half of them.
float cell_depth(ImageView<const float> depth_m, int x0, int y0, int step_px,
                 std::vector<float>& known) {
  known.clear();
  int all = 0;
  for (int y = y0; y < std::min(y0 + step_px, depth_m.size.height); ++y)
    for (int x = x0; x < std::min(x0 + step_px, depth_m.size.width); ++x, ++all)
      if (const float z = depth_m.row(y)[x]; z > 0 && std::isfinite(z)) known.push_back(z);
  if (known.empty() || 2 * static_cast<int>(known.size()) < all) return 0;
  return upper_median_in_place(std::span(known));
}

/// Depth one step beyond `z_m`, after `before_m`: planes go on; what is no plane stays at z_m.
float continued_m(float z_m, float before_m) {
  constexpr float kMostChange = 0.2F;
  if (!(z_m > 0 && before_m > 0)) return z_m;
  const float w = 1 / z_m, change = w - 1 / before_m;
  return std::abs(change) < kMostChange * w ? 1 / (w + change) : z_m;
}

/// A ring of cells around the images, so that the surfaces reach their borders.
void continue_ring(Image<float>& depth_m) {
  const int right = depth_m.width() - 1, bottom = depth_m.height() - 1;
  if (right < 4 || bottom < 4) return;
  for (int y = 1; y < bottom; ++y) {
    float* row = depth_m.row(y);
    row[0] = continued_m(row[1], row[2]);
    row[right] = continued_m(row[right - 1], row[right - 2]);
  }
  for (int x = 0; x <= right; ++x) {
    depth_m.row(0)[x] = continued_m(depth_m.row(1)[x], depth_m.row(2)[x]);
    depth_m.row(bottom)[x] = continued_m(depth_m.row(bottom - 1)[x], depth_m.row(bottom - 2)[x]);
  }
}

/// Samples lie in the middle of their cells; the first and the last ones are the ring.
void make_grid(const BackgroundModel& model, ModelTables& t) {
  const Size size = model.camera.size_px;
  const int step = t.step_px;
  const Size cells{(size.width + step - 1) / step, (size.height + step - 1) / step};
  const Size grid{cells.width + 2, cells.height + 2};
  t.grid.tof_size = grid;
  t.grid.tof_ray.reset(grid);
  t.depth_m.reset(grid, 0.0F);
  std::vector<float> known;
  const double middle = 0.5 * (step - 1);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const Eigen::Vector2d ray =
          model.camera.unproject({(x - 1) * step + middle, (y - 1) * step + middle});
      t.grid.tof_ray.row(y)[x] = glm::vec2(ray.x(), ray.y());
    }
  for (int y = 0; y < cells.height; ++y)
    for (int x = 0; x < cells.width; ++x)
      t.depth_m.row(y + 1)[x + 1] =
          cell_depth(model.images.depth_m, x * step, y * step, step, known);
  continue_ring(t.depth_m);
}

}  // namespace

ModelTables make_model_tables(const CompositorSetup& setup, bool with_normals) {
  const BackgroundModel& model = *setup.background_model;
  const geometry::Pinhole& camera = model.camera;
  ModelTables t;
  const double tof_step_px = camera.fx_px / setup.tof.pinhole.fx_px;
  t.step_px = std::clamp(static_cast<int>(std::lround(tof_step_px)), 1, kMostStepPx);
  make_grid(model, t);
  const NoiseParams noise = noise_params(setup.noise);
  t.grid.correct.noise = {kMedianSigma * noise.floor_m, kMedianSigma * noise.linear,
                          kMedianSigma * noise.quadratic_per_m};
  t.grid.view_size = setup.view.size_px;
  t.grid.warp.view = {glm::vec2(setup.view.fx_px, setup.view.fy_px),
                      glm::vec2(setup.view.cx_px, setup.view.cy_px)};
  t.grid.tof_footprint_px =
      static_cast<float>(std::max(1.0, t.step_px * setup.view.fx_px / camera.fx_px));
  t.limit_radius_px = limit_radius_px(tof_footprint_px(setup));
  t.camera = {glm::vec2(camera.fx_px, camera.fy_px), glm::vec2(camera.cx_px, camera.cy_px)};
  t.w.reset(camera.size_px);
  for (int y = 0; y < t.w.height(); ++y)
    for (int x = 0; x < t.w.width(); ++x) {
      const float z = model.images.depth_m.row(y)[x];
      t.w.row(y)[x] = z > 0 && std::isfinite(z) ? 1 / z : 0;
    }
  if (with_normals)
    t.normal = normals(model.images.depth_m, camera, 2 * static_cast<int>(std::ceil(tof_step_px)));
  return t;
}

ModelPose model_pose(const geometry::Pose& world_from_model,
                     const geometry::Pose& world_from_camera) {
  const geometry::Pose camera_from_model = geometry::inverse(world_from_camera) * world_from_model;
  return {glm::mat4(to_glm(camera_from_model.matrix())),
          glm::mat4(to_glm(geometry::inverse(camera_from_model).matrix()))};
}

}  // namespace mixrig::render
