// SPDX-License-Identifier: Apache-2.0
// A rig and the board before it.
#include "host/calibrate/rig/rig_model.h"

#include <algorithm>

#include <Eigen/Core>

#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::calibration {
namespace {

geometry::Pose moved(const geometry::Pose& pose, const Eigen::Matrix<double, 6, 1>& step) {
  return {(estimation::rotation_exp(step.head<3>()) * pose.rotation).normalized(),
          pose.translation_m + step.tail<3>()};
}

}  // namespace

RigLayout layout_of(const RigModel& model, const RigSwitches& switches) {
  RigLayout layout;
  for (std::size_t c = 0; c < model.cameras.size(); ++c) {
    RigLayout::Camera place;
    place.intrinsics = layout.count;
    layout.count += static_cast<int>(model.cameras[c].free.size());
    if (c > 0) place.extrinsics = layout.count, layout.count += 6;
    if (switches.blur) place.blur = layout.count++;
    layout.cameras.push_back(place);
  }
  if (switches.bend) layout.bend = layout.count, layout.count += 3;
  if (switches.depth)
    layout.depth = layout.count, layout.count += static_cast<int>(model.depth.knots_m.size());
  return layout;
}

void apply_step(RigModel& model, const RigLayout& layout, const Eigen::VectorXd& shared,
                const std::vector<Eigen::Matrix<double, 6, 1>>& views) {
  for (std::size_t c = 0; c < model.cameras.size(); ++c) {
    RigCamera& camera = model.cameras[c];
    const RigLayout::Camera& place = layout.cameras[c];
    for (std::size_t i = 0; i < camera.free.size(); ++i)
      camera.parameters[camera.free[i]] += shared[place.intrinsics + static_cast<int>(i)];
    if (place.extrinsics >= 0)
      camera.camera_from_target =
          moved(camera.camera_from_target, shared.segment<6>(place.extrinsics));
    if (place.blur >= 0)
      camera.blur_px = std::clamp(camera.blur_px + shared[place.blur], 0.05, 20.0);
  }
  if (layout.bend >= 0) model.bend += shared.segment<3>(layout.bend);
  if (layout.depth >= 0)
    for (std::size_t k = 0; k < model.depth.error_m.size(); ++k)
      model.depth.error_m[k] += shared[layout.depth + static_cast<int>(k)];
  for (std::size_t v = 0; v < views.size(); ++v)
    model.target_from_board[v] = moved(model.target_from_board[v], views[v]);
}

BoardPoint board_point(const RigModel& model, int columns, int rows, const Eigen::Vector2d& uv) {
  const double sx = 2.0 / columns, sy = 2.0 / rows;
  const double x = sx * uv.x() - 1, y = sy * uv.y() - 1;
  const Eigen::Vector3d& b = model.bend;
  BoardPoint point;
  point.p_m = {model.square_m * uv.x(), model.square_m * uv.y(),
               b[0] * x * x + b[1] * x * y + b[2] * y * y};
  point.d_uv << model.square_m, 0, 0, model.square_m, sx * (2 * b[0] * x + b[1] * y),
      sy * (b[1] * x + 2 * b[2] * y);
  return point;
}

void spline_basis(const std::vector<double>& knots, double at, Eigen::VectorXd& values) {
  const int n = static_cast<int>(knots.size());
  values.setZero(n);
  at = std::clamp(at, knots.front(), knots.back());
  const auto right = std::upper_bound(knots.begin() + 1, knots.end() - 1, at);
  const int i = static_cast<int>(right - knots.begin()) - 1;
  const double h = knots[i + 1] - knots[i], b = (at - knots[i]) / h, a = 1 - b;
  values[i] = a, values[i + 1] = b;
  if (n < 3) return;
  // Second derivatives are linear in the values: tridiagonal system, natural ends.
  Eigen::MatrixXd left = Eigen::MatrixXd::Identity(n, n), by_value = Eigen::MatrixXd::Zero(n, n);
  for (int k = 1; k + 1 < n; ++k) {
    const double before = knots[k] - knots[k - 1], after = knots[k + 1] - knots[k];
    left(k, k - 1) = before, left(k, k) = 2 * (before + after), left(k, k + 1) = after;
    by_value(k, k - 1) = 6 / before, by_value(k, k + 1) = 6 / after;
    by_value(k, k) = -6 / before - 6 / after;
  }
  const Eigen::MatrixXd second = estimation::solve_by_lu(left, by_value);
  values += ((a * a * a - a) * second.row(i) + (b * b * b - b) * second.row(i + 1)).transpose() *
            (h * h / 6);
}

}  // namespace mixrig::calibration
