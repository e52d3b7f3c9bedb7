// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/views/bundle.h"

#include <array>

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

}  // namespace

bool adjust(Bundle& bundle, int iterations, int threads) {
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

}  // namespace mixrig::reconstruction
