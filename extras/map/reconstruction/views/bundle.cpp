// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/views/bundle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "extras/map/reconstruction/views/rays.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::reconstruction {
namespace {

struct RayResidual {
  estimation::Bearing ray;

  /// `view`: rotation vector and translation of camera_from_map.
  template <typename T>
  bool operator()(const T* view, const T* place, T* residual) const {
    Eigen::Matrix<T, 3, 1> p;
    ceres::AngleAxisRotatePoint(view, place, p.data());
    for (int k = 0; k < 3; ++k) p[k] += view[3 + k];
    Eigen::Map<Eigen::Matrix<T, 2, 1>> out(residual);
    out = ray_error<T>(ray, p);
    return true;
  }
};

struct RangeResidual {
  BundleRange range;

  template <typename T>
  bool operator()(const T* view, const T* place, T* residual) const {
    Eigen::Matrix<T, 3, 1> p;
    ceres::AngleAxisRotatePoint(view, place, p.data());
    for (int k = 0; k < 3; ++k) p[k] += view[3 + k];
    residual[0] = (p.norm() - range.range) / range.sigma;
    return true;
  }
};

bool is_finite(const Bundle& bundle) {
  const auto all = [](const auto& of, const auto& test) {
    return std::all_of(of.begin(), of.end(), test);
  };
  return all(bundle.camera_from_map,
             [](const geometry::Pose& p) {
               return p.rotation.coeffs().allFinite() && p.translation_m.allFinite();
             }) &&
         all(bundle.places, [](const Eigen::Vector3d& p) { return p.allFinite(); }) &&
         all(bundle.rays,
             [](const BundleRay& r) {
               return r.ray.direction.allFinite() && r.ray.whitener.allFinite();
             }) &&
         all(bundle.ranges, [](const BundleRange& r) {
           return std::isfinite(r.range) && std::isfinite(r.sigma) && r.sigma > 0;
         });
}

/// Moves the origin of the map by `by`.
void move_origin(Bundle& bundle, const Eigen::Vector3d& by) {
  for (geometry::Pose& p : bundle.camera_from_map) p.translation_m += p.rotation * by;
  for (Eigen::Vector3d& p : bundle.places) p -= by;
}

bool solve_bundle(Bundle& bundle, int iterations, int threads) {
  std::vector<std::array<double, 6>> views(bundle.camera_from_map.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Eigen::Vector3d turn = estimation::rotation_log(bundle.camera_from_map[i].rotation);
    const Eigen::Vector3d& shift = bundle.camera_from_map[i].translation_m;
    views[i] = {turn.x(), turn.y(), turn.z(), shift.x(), shift.y(), shift.z()};
  }
  std::vector<Eigen::Vector3d> places = bundle.places;
  ceres::Problem problem;
  constexpr double kHuberSigmas = 2;
  for (const BundleRay& r : bundle.rays)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<RayResidual, 2, 6, 3>(new RayResidual{r.ray}),
        new ceres::HuberLoss(kHuberSigmas), views[static_cast<std::size_t>(r.view)].data(),
        places[static_cast<std::size_t>(r.place)].data());
  for (const BundleRange& r : bundle.ranges)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<RangeResidual, 1, 6, 3>(new RangeResidual{r}),
        new ceres::CauchyLoss(kHuberSigmas), views[static_cast<std::size_t>(r.view)].data(),
        places[static_cast<std::size_t>(r.place)].data());
  for (std::size_t i = 0; i < views.size(); ++i)
    if (bundle.fixed[i] && problem.HasParameterBlock(views[i].data()))
      problem.SetParameterBlockConstant(views[i].data());
  ceres::Solver::Options options;
  constexpr std::size_t kDense = 80;
  options.linear_solver_type = views.size() > kDense ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // SuiteSparse has GPL parts
  options.max_num_iterations = iterations;
  options.num_threads = threads;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return false;
  for (std::size_t i = 0; i < views.size(); ++i)
    bundle.camera_from_map[i] = {estimation::rotation_exp({views[i][0], views[i][1], views[i][2]}),
                                 {views[i][3], views[i][4], views[i][5]}};
  bundle.places = std::move(places);
  return true;
}

}  // namespace

Result<void> adjust(Bundle& bundle, int iterations, int threads) {
  if (!is_finite(bundle))
    return Error{
        ErrorCode::kData,
        "bundle: a pose, place, ray or distance is not a finite number, or its sigma is 0"};
  Eigen::Vector3d middle(0, 0, 0);
  for (const Eigen::Vector3d& p : bundle.places)
    middle += p / static_cast<double>(bundle.places.size());
  const auto poses = bundle.camera_from_map;
  const auto places = bundle.places;
  move_origin(bundle, middle);
  if (!solve_bundle(bundle, iterations, threads)) {
    bundle.camera_from_map = poses, bundle.places = places;
    return Error{ErrorCode::kData, "bundle: no poses and places explain its rays"};
  }
  move_origin(bundle, -middle);
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (bundle.fixed[i]) bundle.camera_from_map[i] = poses[i];
  return {};
}

}  // namespace mixrig::reconstruction
