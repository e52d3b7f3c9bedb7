// SPDX-License-Identifier: Apache-2.0
#include "host/render/background_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/base/order_statistics.h"

namespace mixrig::render {
namespace {

constexpr int kMostStepPx = 16;
/// A sample's depth is the median of the model's pixels around it.
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

void make_grid(const BackgroundModel& model, ModelTables& t) {
  const Size size = model.camera.size_px;
  const Size grid{(size.width + t.step_px - 1) / t.step_px,
                  (size.height + t.step_px - 1) / t.step_px};
  t.ray.reset(grid);
  t.depth_m.reset(grid);
  std::vector<float> known;
  const double middle = 0.5 * (t.step_px - 1);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const Eigen::Vector2d ray =
          model.camera.unproject({x * t.step_px + middle, y * t.step_px + middle});
      t.ray.row(y)[x] = glm::vec2(ray.x(), ray.y());
      t.depth_m.row(y)[x] =
          cell_depth(model.images.depth_m, x * t.step_px, y * t.step_px, t.step_px, known);
    }
}

}  // namespace

ModelTables make_model_tables(const CompositorSetup& setup, bool with_normals) {
  const BackgroundModel& model = *setup.background_model;
  const geometry::Pinhole& camera = model.camera;
  ModelTables t;
  const double tof_step_px = camera.fx_px / setup.tof.pinhole.fx_px;
  t.step_px = std::clamp(static_cast<int>(tof_step_px), 1, kMostStepPx);
  make_grid(model, t);
  t.noise = noise_params(setup.noise);
  t.noise = {kMedianSigma * t.noise.floor_m, kMedianSigma * t.noise.linear,
             kMedianSigma * t.noise.quadratic_per_m};
  t.camera = {glm::vec2(camera.fx_px, camera.fy_px), glm::vec2(camera.cx_px, camera.cy_px)};
  if (with_normals)
    t.normal = normals(model.images.depth_m, camera, 2 * static_cast<int>(std::ceil(tof_step_px)));
  t.footprint_px = static_cast<float>(std::max(1.0, t.step_px * setup.view.fx_px / camera.fx_px));
  return t;
}

}  // namespace mixrig::render
