// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/intrinsics/start_bundle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::calibration {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

geometry::AnyCamera plain_camera(geometry::LensKind kind, Size size, double focal_px) {
  Eigen::VectorXd v = Eigen::VectorXd::Zero(geometry::parameter_count(kind));
  v.head<4>() << focal_px, focal_px, 0.5 * (size.width - 1), 0.5 * (size.height - 1);
  return geometry::make_camera(kind, size, v);
}

}  // namespace

std::optional<PoseVector> pose_from_rays(const geometry::AnyCamera& camera,
                                         const BundleView& view) {
  Vector2d middle = Vector2d::Zero();
  for (const auto& p : view.points_m)
    middle += p.head<2>() / static_cast<double>(view.points_m.size());
  double extent = 0;
  for (const auto& p : view.points_m) extent = std::max(extent, (p.head<2>() - middle).norm());
  if (!(extent > 0)) return std::nullopt;
  // ray x (H X) = 0, linear in the columns of H.
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  std::vector<std::pair<Vector3d, Vector3d>> pairs;
  for (std::size_t i = 0; i < view.px.size(); ++i) {
    if (view.used[i] == 0) continue;
    const auto ray = geometry::unproject(camera, view.px[i]);
    if (!ray) continue;
    const Vector3d x(((view.points_m[i].head<2>() - middle) / extent).homogeneous());
    const Matrix3d cross = estimation::skew(*ray);
    Eigen::Matrix<double, 3, 9> row;
    row << x[0] * cross, x[1] * cross, x[2] * cross;
    normal += row.transpose() * row;
    pairs.emplace_back(*ray, x);
  }
  if (pairs.size() < 4) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = estimation::dense_spectrum_of(normal).axes.col(0);
  Matrix3d homography = Eigen::Map<const Matrix3d>(h.data());
  double before = 0;
  for (const auto& [ray, x] : pairs) before += ray.dot(homography * x) > 0 ? 1 : -1;
  if (before < 0) homography = -homography;
  const double scale = 0.5 * (homography.col(0).norm() + homography.col(1).norm());
  if (!(scale > 1e-12)) return std::nullopt;
  homography /= scale;
  Matrix3d near;
  near << homography.col(0), homography.col(1), homography.col(0).cross(homography.col(1));
  const estimation::RotationFit fit = estimation::fit_rotation(near);
  const Matrix3d rotation = fit.rotation.toRotationMatrix();
  if (fit.mirrored || !rotation.allFinite()) return std::nullopt;
  const Vector3d t = homography.col(2) * extent - rotation * Vector3d(middle.x(), middle.y(), 0);
  return vector_of({Eigen::Quaterniond(rotation), t});
}

bool start(Bundle& bundle, Size size_px) {
  constexpr int kSteps = 40;
  constexpr double kNarrowest = 6, kWidest = 0.15;  // focal length over picture width
  double least = std::numeric_limits<double>::infinity();
  Bundle best = bundle;
  for (int s = 0; s < kSteps; ++s) {
    const double focal_px =
        size_px.width * kWidest * std::pow(kNarrowest / kWidest, s / (kSteps - 1.0));
    const auto camera = plain_camera(bundle.kind, size_px, focal_px);
    Bundle tried = bundle;
    tried.intrinsics = geometry::parameters_of(camera);
    std::vector<double> errors;
    for (BundleView& view : tried.views) {
      const auto pose = pose_from_rays(camera, view);
      if (pose) view.camera_from_board = *pose;
      errors.push_back(pose ? misfit(tried, view).rms_px() : 1e6);
    }
    const double error = upper_median(errors);
    if (error < least) least = error, best = tried;
  }
  constexpr double kNoFit_px = 200;
  if (!(least < kNoFit_px)) return false;
  bundle = best;
  return true;
}

}  // namespace mixrig::calibration
