// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/triangulation.h"

#include <cmath>

#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/small_solve.h"

namespace mixrig::estimation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using PointViews = std::span<const PointView>;

struct RayFix {
  Vector3d position;
  Matrix3d information;  // in units of depth_m
  double depth_m;        // mean distance to the cameras
};

struct ReprojectionResiduals {
  PointViews views;
  std::span<const int> indices;
  Vector3d start;
  double scale_m;

  int NumResiduals() const { return 2 * static_cast<int>(indices.size()); }
  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    using Vector3T = Eigen::Matrix<T, 3, 1>;
    int row = 0;
    for (int i : indices) {
      const PointView& view = views[i];
      const Vector3d arm = (start - view.world_from_camera.translation_m) / scale_m;
      const Vector3T in_world(x[0] + arm.x(), x[1] + arm.y(), x[2] + arm.z());
      const Matrix3d camera_from_world =
          view.world_from_camera.rotation.conjugate().toRotationMatrix();
      const Vector3T p = camera_from_world.cast<T>() * in_world;
      const Eigen::Matrix<T, 2, 1> r = bearing_error<T>(view.bearing, p);
      residuals[row++] = r.x();
      residuals[row++] = r.y();
    }
    return true;
  }
};

/// The noise of the inverse depth is normal, that of the depth is not: from a share of a sixth on,
/// the sigma of the depth no longer describes its error.
constexpr double kDegenerateDepthShare = 1.0 / 6.0;

/// Least squares of the distances to the rays, each weighted by its precision over the distance of
/// the round before: converges to the reprojection error in most configurations (Cortes Reina 2015,
/// eq. 53 to 57).
std::optional<Vector3d> linear_start(PointViews views, std::span<const int> indices) {
  const Vector3d origin = views[indices[0]].world_from_camera.translation_m;
  Vector3d x = Vector3d::Zero();
  for (int round = 0; round < 4; ++round) {
    Matrix3d a = Matrix3d::Zero();
    Vector3d b = Vector3d::Zero();
    for (int i : indices) {
      const Vector3d c = views[i].world_from_camera.translation_m - origin;
      const Vector3d d = views[i].world_from_camera.rotation * views[i].bearing.direction;
      const double sharpness = views[i].bearing.whitener.squaredNorm();
      const double weight = round == 0 ? sharpness : sharpness / (x - c).squaredNorm();
      const Matrix3d across = weight * (Matrix3d::Identity() - d * d.transpose());
      a += across;
      b += across * c;
    }
    const Spectrum spectrum = spectrum_of(a);
    if (!(spectrum.values[0] > 1e-15 * spectrum.values[2])) return std::nullopt;
    x = spectrum.axes * spectrum.values.cwiseInverse().asDiagonal() * spectrum.axes.transpose() * b;
    if (!x.allFinite()) return std::nullopt;
  }
  return Vector3d(origin + x);
}

std::optional<RayFix> solve(PointViews views, std::span<const int> indices) {
  const auto start = linear_start(views, indices);
  if (!start) return std::nullopt;
  double depth_m = 0;
  for (int i : indices) depth_m += (*start - views[i].world_from_camera.translation_m).norm();
  depth_m /= static_cast<double>(indices.size());
  const auto solution = detail::minimise<3>(ReprojectionResiduals{views, indices, *start, depth_m});
  if (!(depth_m > 0) || !solution.finite()) return std::nullopt;
  return RayFix{*start + depth_m * solution.x, solution.information(), depth_m};
}

double squared_residual(const PointView& view, const Vector3d& point) {
  const Vector3d p =
      view.world_from_camera.rotation.conjugate() * (point - view.world_from_camera.translation_m);
  return bearing_error<double>(view.bearing, p).squaredNorm();
}

/// Greatest distance between two of the cameras, m.
double baseline_of(PointViews views, std::span<const int> indices) {
  double longest = 0;
  for (int i : indices)
    longest = std::max(longest, (views[i].world_from_camera.translation_m -
                                 views[indices[0]].world_from_camera.translation_m)
                                    .norm());
  return longest;
}

std::string input_fault(PointViews views) {
  if (views.size() < 2) return "fewer than 2 views";
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PointView& v = views[i];
    if (!v.world_from_camera.translation_m.allFinite() ||
        std::abs(v.world_from_camera.rotation.norm() - 1) > 1e-6 ||
        !v.bearing.whitener.allFinite() || !(v.bearing.whitener.squaredNorm() > 0) ||
        std::abs(v.bearing.direction.norm() - 1) > 1e-6)
      return "view " + std::to_string(i) + " holds a value that is not finite, or no unit vector";
  }
  return {};
}

/// Whether the point lies opposite to where most of the views look.
bool is_behind(PointViews views, const ConsensusFit<RayFix>& found) {
  for (int i : found.inliers) {
    const Vector3d ray = views[i].world_from_camera.rotation * views[i].bearing.direction;
    if (ray.dot(found.model->position - views[i].world_from_camera.translation_m) <= 0) return true;
  }
  return false;
}

}  // namespace

Estimate<Vector3d> triangulate(PointViews views) {
  using Answer = Estimate<Vector3d>;
  if (auto fault = input_fault(views); !fault.empty()) return Answer::degenerate(fault);
  const int n = static_cast<int>(views.size());
  const auto fit = [&](std::span<const int> indices) { return solve(views, indices); };
  const auto sample = [&](std::span<const int> indices) {
    const auto start = linear_start(views, indices);
    return start ? std::vector<RayFix>{{*start, {}, 0}} : std::vector<RayFix>{};
  };
  const auto cost = [&](const RayFix& fix, int i) {
    return squared_residual(views[i], fix.position);
  };
  std::vector<int> everything(n);
  std::iota(everything.begin(), everything.end(), 0);
  if (baseline_of(views, everything) == 0)
    return Answer::degenerate("all views are from one place: no baseline");
  auto found = fit_with_consensus<RayFix>({n, 2, 2, 3}, true, fit, sample, cost);
  if (!found.model)
    return Answer::degenerate(solve(views, everything) ? found.reason : "the rays are parallel");
  if (is_behind(views, found)) return Answer::degenerate("the rays meet behind a camera");
  const RayFix& fix = *found.model;
  const auto judged = judge(fix.information / (fix.depth_m * fix.depth_m),
                            Vector3d::Constant(fix.depth_m), kDegenerateDepthShare);
  if (judged.verdict.standing == Standing::kDegenerate)
    return Answer::degenerate("the rays are parallel to within their noise: the depth is unknown");
  Eigen::VectorXd residuals(n);
  for (int i = 0; i < n; ++i) residuals[i] = std::sqrt(cost(fix, i));
  return {fix.position, judged.covariance, std::move(residuals), std::move(found.inliers),
          judged.verdict};
}

}  // namespace mixrig::estimation
