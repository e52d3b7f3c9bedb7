// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/external.h"

#include <cmath>
#include <numeric>

#include <ceres/rotation.h>

#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/points/rigid_fit.h"
#include "host/math/estimation/small_solve.h"

namespace mixrig::estimation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::Pose;
using Sights = std::span<const RangedSight>;

struct HeadFit {
  Pose world_from_camera;
  Eigen::MatrixXd information;
};

/// Parameters of pose_error(world_from_camera), lengths in units of `scale_m`.
struct SightResiduals {
  Sights sights;
  std::span<const int> indices;
  Pose start;
  double scale_m, sigma_m;

  int NumResiduals() const { return 3 * static_cast<int>(indices.size()); }
  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    using Vector3T = Eigen::Matrix<T, 3, 1>;
    const T back[3] = {-x[0], -x[1], -x[2]};
    int row = 0;
    for (int i : indices) {
      const RangedSight& sight = sights[i];
      Vector3T arm = ((sight.world_m - start.translation_m) / scale_m).cast<T>();
      for (int k = 0; k < 3; ++k) arm[k] -= x[3 + k];
      Vector3T turned;
      ceres::AngleAxisRotatePoint(back, arm.data(), turned.data());
      const Vector3T seen = start.rotation.conjugate().toRotationMatrix().cast<T>() * turned;
      const T range = seen.norm();
      const Eigen::Matrix<T, 2, 1> across = bearing_error<T>(sight.bearing, seen);
      residuals[row++] = across.x();
      residuals[row++] = across.y();
      residuals[row++] = (range * scale_m - sight.range_m) / sigma_m;
    }
    return true;
  }
};

double squared_residual(const RangedSight& sight, const Pose& world_from_camera, double sigma_m) {
  const Vector3d seen = geometry::inverse(world_from_camera) * sight.world_m;
  return bearing_error<double>(sight.bearing, seen).squaredNorm() +
         std::pow((seen.norm() - sight.range_m) / sigma_m, 2);
}

/// Each sight is a point in camera axes: the pose is a rigid fit.
std::optional<Pose> start_of(Sights sights, std::span<const int> indices) {
  std::vector<Vector3d> in_camera, in_world;
  for (const RangedSight& s : sights) {
    in_camera.push_back(s.range_m * s.bearing.direction);
    in_world.push_back(s.world_m);
  }
  return align_points(in_camera, in_world, indices);
}

std::optional<HeadFit> solve(Sights sights, std::span<const int> indices, double sigma_m) {
  const auto start = start_of(sights, indices);
  if (!start) return std::nullopt;
  double scale_m = 0;
  for (int i : indices) scale_m = std::max(scale_m, sights[i].range_m);
  HeadFit fix{*start, {}};
  // The second pass starts at the minimum, so its Jacobian is that of pose_error().
  for (int pass = 0; pass < 2; ++pass) {
    const auto solution = detail::minimise<6>(
        SightResiduals{sights, indices, fix.world_from_camera, scale_m, sigma_m});
    if (!solution.finite()) return std::nullopt;
    Pose& pose = fix.world_from_camera;
    pose.rotation = (rotation_exp(solution.x.head<3>()) * pose.rotation).normalized();
    pose.translation_m += scale_m * solution.x.tail<3>();
    fix.information = solution.information();
  }
  Eigen::Matrix<double, 6, 1> unit = Eigen::Matrix<double, 6, 1>::Ones();
  unit.tail<3>() /= scale_m;
  fix.information = (unit.asDiagonal() * fix.information * unit.asDiagonal()).eval();
  return fix;
}

std::string input_fault(Sights sights, double sigma_m) {
  if (sights.size() < 3) return "fewer than 3 markers";
  if (!(sigma_m > 0) || !std::isfinite(sigma_m)) return "the stated noise must be positive";
  for (std::size_t i = 0; i < sights.size(); ++i)
    if (!sights[i].world_m.allFinite() || !sights[i].bearing.whitener.allFinite() ||
        !(std::abs(sights[i].bearing.direction.norm() - 1) < 1e-6) || !(sights[i].range_m > 0) ||
        !std::isfinite(sights[i].range_m))
      return "marker " + std::to_string(i) +
             " is not finite, has no unit direction or no positive distance";
  return {};
}

/// Spread of the markers across their longest direction, over the uncertainty of a sight there.
bool is_collinear(Sights sights, std::span<const int> indices, double sigma_m) {
  std::vector<Vector3d> markers;
  for (const RangedSight& s : sights) markers.push_back(s.world_m);
  const Vector3d spread_m = spread_of(markers, indices).spread_m;
  return spread_m[1] <= 1e-7 * spread_m[2] || spread_m[1] < 1e-3 * sigma_m;
}

}  // namespace

Estimate<Pose> locate_camera(Sights sights, double sigma_range_m) {
  using Answer = Estimate<Pose>;
  if (auto fault = input_fault(sights, sigma_range_m); !fault.empty())
    return Answer::degenerate(fault);
  const int n = static_cast<int>(sights.size());
  std::vector<int> everything(n);
  std::iota(everything.begin(), everything.end(), 0);
  if (is_collinear(sights, everything, sigma_range_m))
    return Answer::degenerate("the markers lie on one line or coincide");
  const auto fit = [&](std::span<const int> indices) {
    return solve(sights, indices, sigma_range_m);
  };
  const auto sample = [&](std::span<const int> indices) {
    const auto start = start_of(sights, indices);
    return start ? std::vector<HeadFit>{{*start, {}}} : std::vector<HeadFit>{};
  };
  const auto cost = [&](const HeadFit& fix, int i) {
    return squared_residual(sights[i], fix.world_from_camera, sigma_range_m);
  };
  auto found = fit_with_consensus<HeadFit>({n, 3, 3, 6}, true, fit, sample, cost);
  if (!found.model) return Answer::degenerate(found.reason);
  double reach_m = 0;
  for (int i : found.inliers) reach_m = std::max(reach_m, sights[i].range_m);
  Eigen::Matrix<double, 6, 1> extent;
  extent << 1, 1, 1, reach_m, reach_m, reach_m;
  const auto judged = judge(found.model->information, extent);
  if (judged.verdict.standing == Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Eigen::VectorXd residuals(n);
  for (int i = 0; i < n; ++i) residuals[i] = std::sqrt(cost(*found.model, i));
  return {found.model->world_from_camera, judged.covariance, std::move(residuals),
          std::move(found.inliers), judged.verdict};
}

Estimate<Pose> body_from_camera(const Estimate<Pose>& world_from_body,
                                const Estimate<Pose>& world_from_camera) {
  using Answer = Estimate<Pose>;
  if (!world_from_body.usable())
    return Answer::degenerate("the body is not found: " + world_from_body.verdict.reason);
  if (!world_from_camera.usable())
    return Answer::degenerate("the camera is not found: " + world_from_camera.verdict.reason);
  const Pose& body = world_from_body.value;
  const Matrix3d back = body.rotation.conjugate().toRotationMatrix();
  // First order of inverse(exp(w_b) body) * exp(w_c) camera.
  Eigen::Matrix<double, 6, 6> by_camera = Eigen::Matrix<double, 6, 6>::Zero();
  by_camera.topLeftCorner<3, 3>() = by_camera.bottomRightCorner<3, 3>() = back;
  Eigen::Matrix<double, 6, 6> by_body = -by_camera;
  by_body.bottomLeftCorner<3, 3>() =
      back * skew(world_from_camera.value.translation_m - body.translation_m);
  Answer answer;
  answer.value = geometry::inverse(body) * world_from_camera.value;
  answer.covariance = by_camera * world_from_camera.covariance * by_camera.transpose() +
                      by_body * world_from_body.covariance * by_body.transpose();
  answer.residuals = world_from_camera.residuals;
  answer.inliers = world_from_camera.inliers;
  const bool body_is_weak = world_from_body.verdict.standing == Standing::kWeak;
  answer.verdict = body_is_weak ? world_from_body.verdict : world_from_camera.verdict;
  if (answer.verdict.standing == Standing::kWeak) {
    const Eigen::VectorXd step =
        answer.verdict.sigma * (body_is_weak ? by_body : by_camera) * answer.verdict.direction;
    answer.verdict = Verdict::weak(step.normalized(), step.norm(), answer.verdict.reason);
  }
  return answer;
}

}  // namespace mixrig::estimation
