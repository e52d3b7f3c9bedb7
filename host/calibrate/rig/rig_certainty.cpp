// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/rig/rig_certainty.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hal/base/order_statistics.h"
#include "host/calibrate/rig/rig_start.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::calibration {
namespace {

using Eigen::Vector2d;

/// Where the target camera sees the point at a pixel and a depth of another camera; unset where it
/// does not.
std::optional<Vector2d> in_target(const RigModel& model, std::size_t camera, const Vector2d& px,
                                  double depth_m) {
  const RigCamera& other = model.cameras[camera];
  const auto ray =
      geometry::unproject(geometry::make_camera(other.lens, other.size_px, other.parameters), px);
  if (!ray || !(ray->z() > 0)) return std::nullopt;
  const RigCamera& target = model.cameras[0];
  const auto seen = geometry::project_with_jacobians(
      target.lens, target.parameters.data(),
      geometry::inverse(other.camera_from_target) * (depth_m / ray->z() * *ray));
  if (!seen || !(seen->px.minCoeff() >= 0) || !(seen->px.x() < target.size_px.width) ||
      !(seen->px.y() < target.size_px.height))
    return std::nullopt;
  return seen->px;
}

/// Derivatives of in_target() by the shared parameters, by differences; empty where it is unset.
Eigen::MatrixXd by_shared(const RigModel& model, const RigLayout& layout, std::size_t camera,
                          const Vector2d& px, double depth_m, const Eigen::VectorXd& steps) {
  Eigen::MatrixXd j(2, layout.count);
  for (int i = 0; i < layout.count; ++i) {
    std::optional<Vector2d> at[2];
    for (const int side : {0, 1}) {
      RigModel moved = model;
      const Eigen::VectorXd step =
          (side == 0 ? -1 : 1) * steps[i] * Eigen::VectorXd::Unit(layout.count, i);
      apply_step(moved, layout, step, {});
      at[side] = in_target(moved, camera, px, depth_m);
    }
    if (!at[0] || !at[1]) return {};
    j.col(i) = (*at[1] - *at[0]) / (2 * steps[i]);
  }
  return j;
}

double median_distance_m(const RigModel& model, std::size_t camera, const std::vector<int>& views) {
  std::vector<double> all;
  for (const int view : views)
    all.push_back((model.cameras[camera].camera_from_target * model.target_from_board[view])
                      .translation_m.norm());
  return upper_median(all);
}

BundleView bundle_view(const RigData& data, const RigModel& model, std::size_t camera, int view) {
  BundleView out;
  for (const SeenCorner& corner : data.corners[view][camera]) {
    out.points_m.push_back(board_point(model, data.print.columns, data.print.rows, corner.uv).p_m);
    out.px.push_back(corner.px);
  }
  out.used.assign(out.px.size(), 1);
  out.camera_from_board =
      vector_of(model.cameras[camera].camera_from_target * model.target_from_board[view]);
  return out;
}

}  // namespace

Intrinsics seen_alone(const RigData& data, const RigModel& model, std::size_t camera,
                      const std::vector<int>& views) {
  const RigCamera& c = model.cameras[camera];
  const auto lens = geometry::make_camera(c.lens, c.size_px, c.parameters);
  const auto circle = circle_of(data, camera);
  Intrinsics in;
  in.camera = lens;
  if (circle)
    if (const auto rim = rim_angle_rad(lens, *circle))
      in.camera = geometry::make_camera(c.lens, c.size_px, c.parameters, *rim);
  in.bundle.kind = c.lens;
  in.bundle.intrinsics = c.parameters;
  in.bundle.free = c.free;
  for (const int view : views)
    if (!data.corners[view][camera].empty())
      in.bundle.views.push_back(bundle_view(data, model, camera, view));
  for (const BundleView& view : in.bundle.views)
    for (const Vector2d& px : view.px)
      if (const auto ray = geometry::unproject(lens, px))
        in.point_angle_rad = std::max(in.point_angle_rad, std::acos(ray->normalized().z()));
  const CornerError error = corner_error(data, model, camera, views);
  constexpr double kFloor_px = 0.005;
  in.rms_px = error.rms_px;
  in.sigma_px = std::max(error.rms_px / std::sqrt(2.0), kFloor_px);
  in.points = error.corners, in.points_out = data.misfound[camera].corners;
  in.lens_terms = static_cast<int>(c.free.size()) - 4;
  in.circle = circle;
  return in;
}

Registration registration_of(const RigModel& model, const RigLayout& layout,
                             const Eigen::MatrixXd& covariance, std::size_t camera,
                             const std::vector<int>& views) {
  constexpr int kColumns = 7, kRows = 5;
  Registration out{model.cameras[camera].name, median_distance_m(model, camera, views)};
  const Size size = model.cameras[camera].size_px;
  // A tenth of each parameter's standard deviation: the derivative where it matters.
  const Eigen::VectorXd steps =
      (0.1 * covariance.diagonal().cwiseMax(0).cwiseSqrt()).cwiseMax(1e-9);
  std::vector<double> sigmas;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const Vector2d px((i % kColumns + 0.5) * size.width / kColumns - 0.5,
                      (i / kColumns + 0.5) * size.height / kRows - 0.5);
    if (!in_target(model, camera, px, out.distance_m)) continue;
    const Eigen::MatrixXd j = by_shared(model, layout, camera, px, out.distance_m, steps);
    if (j.size() == 0) continue;
    const Eigen::Matrix2d spread = j * covariance * j.transpose();
    sigmas.push_back(std::sqrt(std::max(estimation::planar_spectrum_of(spread).values[1], 0.0)));
  }
  if (sigmas.empty()) return out;
  out.median_px = upper_median(sigmas);
  out.worst_px = *std::max_element(sigmas.begin(), sigmas.end());
  return out;
}

}  // namespace mixrig::calibration
