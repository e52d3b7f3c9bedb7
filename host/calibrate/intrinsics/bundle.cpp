// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/intrinsics/bundle.h"

#include <algorithm>
#include <cmath>

#include <ceres/ceres.h>
#include <glog/logging.h>

#include "host/math/estimation/verdict.h"

namespace mixrig::calibration {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Observed minus projected of one point; blocks: intrinsics, pose.
class PointCost final : public ceres::CostFunction {
 public:
  PointCost(geometry::LensKind kind, const Vector3d& point_m, const Vector2d& px)
      : kind_(kind), point_m_(point_m), px_(px) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {geometry::parameter_count(kind), 6};
  }
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    const PoseVector pose = Eigen::Map<const PoseVector>(blocks[1]);
    const auto at = geometry::project_with_jacobians(kind_, blocks[0], pose_of(pose) * point_m_);
    if (!at) return false;
    Eigen::Map<Vector2d>{residuals} = px_ - at->px;
    if (jacobians == nullptr) return true;
    using Rows = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;
    if (jacobians[0] != nullptr)
      Eigen::Map<Rows>(jacobians[0], 2, at->d_parameters.cols()) = -at->d_parameters;
    if (jacobians[1] != nullptr)
      Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>>{jacobians[1]} =
          -at->d_point * pose_jacobian(pose, point_m_);
    return true;
  }

 private:
  geometry::LensKind kind_;
  Vector3d point_m_;
  Vector2d px_;
};

void add_points(ceres::Problem& problem, Bundle& bundle, double huber_px) {
  ceres::LossFunction* loss = huber_px > 0 ? new ceres::HuberLoss(huber_px) : nullptr;
  for (BundleView& view : bundle.views)
    for (std::size_t i = 0; i < view.px.size(); ++i)
      if (view.used[i] != 0)
        problem.AddResidualBlock(new PointCost(bundle.kind, view.points_m[i], view.px[i]), loss,
                                 bundle.intrinsics.data(), view.camera_from_board.data());
}

void hold_parameters(ceres::Problem& problem, Bundle& bundle) {
  if (!problem.HasParameterBlock(bundle.intrinsics.data())) return;
  if (bundle.free.empty()) return problem.SetParameterBlockConstant(bundle.intrinsics.data());
  std::vector<int> held;
  for (int i = 0; i < bundle.intrinsics.size(); ++i)
    if (std::find(bundle.free.begin(), bundle.free.end(), i) == bundle.free.end())
      held.push_back(i);
  if (!held.empty())
    problem.SetManifold(
        bundle.intrinsics.data(),
        new ceres::SubsetManifold(static_cast<int>(bundle.intrinsics.size()), held));
}

}  // namespace

geometry::Pose pose_of(const PoseVector& v) {
  return {estimation::rotation_exp(v.head<3>()), v.tail<3>()};
}

PoseVector vector_of(const geometry::Pose& pose) {
  PoseVector v;
  v << estimation::rotation_log(pose.rotation), pose.translation_m;
  return v;
}

Eigen::Matrix<double, 3, 6> pose_jacobian(const PoseVector& pose, const Vector3d& p) {
  const Vector3d w = pose.head<3>();
  const double angle = w.norm();
  Matrix3d left = Matrix3d::Identity() + 0.5 * estimation::skew(w);  // of SO(3), to first order
  if (angle > 1e-6) {
    const Vector3d a = w / angle;
    const double s = std::sin(angle) / angle;
    left = s * Matrix3d::Identity() + (1 - s) * a * a.transpose() +
           (1 - std::cos(angle)) / angle * estimation::skew(a);
  }
  Eigen::Matrix<double, 3, 6> j;
  j << -estimation::skew(estimation::rotation_exp(w) * p) * left, Matrix3d::Identity();
  return j;
}

bool solve(Bundle& bundle, double huber_px, Precision precision) {
  ceres::Problem problem;
  add_points(problem, bundle, huber_px);
  hold_parameters(problem, bundle);
  ceres::Solver::Options options;
  options.linear_solver_type =
      bundle.free.empty() ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::DENSE_SCHUR;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // SuiteSparse has GPL parts
  options.max_num_iterations = precision == Precision::kFull ? 200 : 30;
  options.function_tolerance = precision == Precision::kFull ? 1e-12 : 1e-4;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-14;
  // Lens terms can be almost collinear; some damping keeps the matrix positive definite.
  options.max_trust_region_radius = 1e9;
  options.num_threads = 1;  // the sums' order, and so every bit, stays the same
  options.logging_type = ceres::SILENT;
  FLAGS_minloglevel = google::GLOG_FATAL;  // the caller says in its own words what failed
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.IsSolutionUsable() && bundle.intrinsics.allFinite();
}

std::optional<Vector2d> residual(const Bundle& bundle, const BundleView& view, std::size_t i) {
  const auto at = geometry::project_with_jacobians(
      bundle.kind, bundle.intrinsics.data(), pose_of(view.camera_from_board) * view.points_m[i]);
  if (!at) return std::nullopt;
  return Vector2d(view.px[i] - at->px);
}

double Misfit::rms_px() const { return points > 0 ? std::sqrt(squares / points) : 0; }

Misfit misfit(const Bundle& bundle, const BundleView& view) {
  Misfit sum;
  for (std::size_t i = 0; i < view.px.size(); ++i) {
    if (view.used[i] == 0) continue;
    const auto r = residual(bundle, view, i);
    constexpr double kNowhere_px = 1e3;
    sum.squares += r ? r->squaredNorm() : kNowhere_px * kNowhere_px;
    ++sum.points;
  }
  return sum;
}

Misfit misfit(const Bundle& bundle) {
  Misfit sum;
  for (const BundleView& view : bundle.views) {
    const Misfit one = misfit(bundle, view);
    sum.squares += one.squares;
    sum.points += one.points;
  }
  return sum;
}

Eigen::MatrixXd information(const Bundle& bundle) {
  const auto count = static_cast<Eigen::Index>(bundle.free.size());
  const Eigen::Index size = count + 6 * static_cast<Eigen::Index>(bundle.views.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  Eigen::Matrix<double, 2, Eigen::Dynamic> inner(2, count);
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    const BundleView& view = bundle.views[v];
    const Eigen::Index at = count + 6 * static_cast<Eigen::Index>(v);
    const geometry::Pose pose = pose_of(view.camera_from_board);
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      if (view.used[i] == 0) continue;
      const auto p = geometry::project_with_jacobians(bundle.kind, bundle.intrinsics.data(),
                                                      pose * view.points_m[i]);
      if (!p) continue;
      for (Eigen::Index k = 0; k < count; ++k)
        inner.col(k) = p->d_parameters.col(bundle.free[static_cast<std::size_t>(k)]);
      const Eigen::Matrix<double, 2, 6> outer =
          p->d_point * pose_jacobian(view.camera_from_board, view.points_m[i]);
      sum.topLeftCorner(count, count) += inner.transpose() * inner;
      sum.block(0, at, count, 6) += inner.transpose() * outer;
      sum.block<6, 6>(at, at) += outer.transpose() * outer;
    }
  }
  return sum.selfadjointView<Eigen::Upper>();
}

}  // namespace mixrig::calibration
