// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/pnp.h"

#include <cmath>
#include <limits>

#include <ceres/rotation.h>

#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/pose/p3p.h"
#include "host/math/estimation/small_solve.h"

namespace mixrig::estimation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::Pose;
using Points = std::span<const Vector3d>;
using Bearings = std::span<const Bearing>;

/// A pose, its information about the centroid of its points, and the next best pose.
struct PoseFit {
  Pose camera_from_world;
  Eigen::Matrix<double, 6, 6> information;
  Vector3d centroid;
  double cost = 0;
  std::optional<double> rival_cost;
};

/// Parameters: rotation vector about the centroid, translation in units of the depth.
struct PnpResiduals {
  Points points;
  Bearings bearings;
  std::span<const int> indices;
  Pose start;
  Vector3d centroid;
  double depth_m;

  int NumResiduals() const { return 2 * static_cast<int>(indices.size()); }
  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    using Vector3T = Eigen::Matrix<T, 3, 1>;
    const Vector3d centre = (start * centroid) / depth_m;
    int row = 0;
    for (int i : indices) {
      const Vector3T arm = (start.rotation * ((points[i] - centroid) / depth_m)).cast<T>();
      Vector3T p;
      ceres::AngleAxisRotatePoint(x, arm.data(), p.data());
      for (int k = 0; k < 3; ++k) p[k] += x[3 + k] + centre[k];
      const Eigen::Matrix<T, 2, 1> r = bearing_error<T>(bearings[i], p);
      residuals[row++] = r.x();
      residuals[row++] = r.y();
    }
    return true;
  }
};

double squared_residual(const Pose& camera_from_world, const Vector3d& point,
                        const Bearing& bearing) {
  // The whitened error of a point straight behind the camera is zero too.
  const Vector3d seen = camera_from_world * point;
  if (!(seen.dot(bearing.direction) > 0)) return std::numeric_limits<double>::infinity();
  return bearing_error<double>(bearing, seen).squaredNorm();
}

Vector3d centroid_of(Points points, std::span<const int> indices) {
  Vector3d sum = Vector3d::Zero();
  for (int i : indices) sum += points[i] - points[indices[0]];
  return points[indices[0]] + sum / static_cast<double>(indices.size());
}

std::vector<Pose> poses_of_triple(Points points, Bearings bearings, std::span<const int> t) {
  // Differences to the first point keep the digits far from the origin.
  const Vector3d origin = points[t[0]];
  auto poses =
      solve_p3p({Vector3d::Zero(), points[t[1]] - origin, points[t[2]] - origin},
                {bearings[t[0]].direction, bearings[t[1]].direction, bearings[t[2]].direction});
  for (Pose& pose : poses) pose.translation_m -= pose.rotation * origin;
  return poses;
}

std::optional<PoseFit> refine(Points points, Bearings bearings, std::span<const int> indices,
                              const Pose& start) {
  const Vector3d centroid = centroid_of(points, indices);
  const double depth_m = (start * centroid).norm();
  const auto first =
      detail::minimise<6>(PnpResiduals{points, bearings, indices, start, centroid, depth_m});
  if (!(depth_m > 0) || !first.finite()) return std::nullopt;
  PoseFit fit{{}, first.information(), centroid, first.cost(), std::nullopt};
  fit.camera_from_world.rotation = (rotation_exp(first.x.head<3>()) * start.rotation).normalized();
  const Vector3d centre = start * centroid + depth_m * first.x.tail<3>();
  fit.camera_from_world.translation_m = centre - fit.camera_from_world.rotation * centroid;
  // The information belongs to small rotations at the minimum: chart of exp at x.
  Eigen::Matrix<double, 6, 6> chart = Eigen::Matrix<double, 6, 6>::Identity();
  const Matrix3d w = skew(first.x.head<3>());
  chart.topLeftCorner<3, 3>() += -0.5 * w + w * w / 12.0;
  chart.bottomRightCorner<3, 3>() /= depth_m;
  fit.information = chart.transpose() * fit.information * chart;
  return fit;
}

/// The other pose that a plane seen from afar may have: depths mirrored about the centroid.
/// Exact for coplanar points under parallel rays; for others merely a poor start.
Pose flipped(Points points, std::span<const int> indices, const PoseFit& fit) {
  const Vector3d normal = spread_of(points, indices).axes.col(0);
  const Vector3d centre = fit.camera_from_world * fit.centroid;
  const Vector3d sight = centre.normalized();
  const Matrix3d mirror_sight = Matrix3d::Identity() - 2 * sight * sight.transpose();
  const Matrix3d mirror_plane = Matrix3d::Identity() - 2 * normal * normal.transpose();
  Pose flip;
  flip.rotation = Eigen::Quaterniond(
      Matrix3d(mirror_sight * fit.camera_from_world.rotation.toRotationMatrix() * mirror_plane));
  flip.translation_m = centre - flip.rotation * fit.centroid;
  return flip;
}

/// Best pose of all given points: starts from a spread of triples, refines the best distinct ones.
std::optional<PoseFit> solve(Points points, Bearings bearings, std::span<const int> indices) {
  struct Start {
    Pose pose;
    double cost;
  };
  std::vector<Start> starts;
  const int n = static_cast<int>(indices.size());
  constexpr int kTriples = 20;
  detail::visit_samples(n, 3, kTriples, [&](std::span<const int> sample) {
    const int triple[3] = {indices[sample[0]], indices[sample[1]], indices[sample[2]]};
    for (const Pose& pose : poses_of_triple(points, bearings, triple)) {
      double cost = 0;
      for (int i : indices) cost += squared_residual(pose, points[i], bearings[i]);
      if (std::isfinite(cost)) starts.push_back({pose, cost});
    }
    return true;
  });
  std::sort(starts.begin(), starts.end(),
            [](const Start& a, const Start& b) { return a.cost < b.cost; });
  std::vector<PoseFit> fits;
  constexpr double kDistinctRad = 0.05;
  constexpr std::size_t kRefined = 3;
  std::vector<Pose> tried;
  for (const Start& start : starts) {
    if (tried.size() >= kRefined) break;
    bool known = false;
    for (const Pose& other : tried)
      known = known || start.pose.rotation.angularDistance(other.rotation) < kDistinctRad;
    if (known) continue;
    tried.push_back(start.pose);
    if (const auto fit = refine(points, bearings, indices, start.pose)) fits.push_back(*fit);
  }
  if (fits.empty()) return std::nullopt;
  const auto cheaper = [](const PoseFit& a, const PoseFit& b) { return a.cost < b.cost; };
  std::sort(fits.begin(), fits.end(), cheaper);
  if (const auto flip = refine(points, bearings, indices, flipped(points, indices, fits[0])))
    fits.push_back(*flip);
  std::sort(fits.begin(), fits.end(), cheaper);
  PoseFit best = fits[0];
  for (const PoseFit& other : fits)
    if (!best.rival_cost &&
        best.camera_from_world.rotation.angularDistance(other.camera_from_world.rotation) > 1e-3)
      best.rival_cost = other.cost;
  return best;
}

std::string input_fault(Points points, Bearings bearings) {
  if (points.size() != bearings.size()) return "there must be one bearing per point";
  if (points.size() < 4) return "fewer than 4 points";
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite() || !bearings[i].whitener.allFinite() ||
        !(std::abs(bearings[i].direction.norm() - 1) < 1e-6))
      return "point " + std::to_string(i) + " is not finite, or its bearing is no unit vector";
  return {};
}

/// Spread of the points along their second principal axis over the first.
double flatness(Points points, std::span<const int> indices) {
  const Vector3d spread_m = spread_of(points, indices).spread_m;
  return spread_m[2] > 0 ? spread_m[1] / spread_m[2] : 0.0;
}

}  // namespace

Estimate<Pose> solve_pnp(Points points_m, Bearings bearings) {
  using Answer = Estimate<Pose>;
  if (auto fault = input_fault(points_m, bearings); !fault.empty())
    return Answer::degenerate(fault);
  const int n = static_cast<int>(points_m.size());
  std::vector<int> everything(n);
  std::iota(everything.begin(), everything.end(), 0);
  if (flatness(points_m, everything) < 1e-6)
    return Answer::degenerate("the points lie on one line or coincide");
  const auto fit_to = [&](std::span<const int> indices) {
    return solve(points_m, bearings, indices);
  };
  const auto sample = [&](std::span<const int> triple) {
    std::vector<PoseFit> fits;
    for (const Pose& pose : poses_of_triple(points_m, bearings, triple))
      fits.push_back({pose, {}, {}, 0, std::nullopt});
    return fits;
  };
  const auto cost = [&](const PoseFit& fit, int i) {
    return squared_residual(fit.camera_from_world, points_m[i], bearings[i]);
  };
  auto found = fit_with_consensus<PoseFit>({n, 3, 2, 6}, true, fit_to, sample, cost);
  if (!found.model) return Answer::degenerate(found.reason);
  const PoseFit& fit = *found.model;
  if (flatness(points_m, found.inliers) < 1e-6)
    return Answer::degenerate("the points that agree lie on one line");
  // A rival within 3 sigma of likelihood is not ruled out by the data.
  if (fit.rival_cost && *fit.rival_cost - fit.cost < 9)
    return Answer::degenerate("two poses explain the points equally well");
  const double depth_m = (fit.camera_from_world * fit.centroid).norm();
  Eigen::Matrix<double, 6, 1> extent;
  extent << 1, 1, 1, depth_m, depth_m, depth_m;
  const auto judged = judge(fit.information, extent);
  if (judged.verdict.standing == Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Eigen::VectorXd residuals(n);
  for (int i = 0; i < n; ++i) residuals[i] = std::sqrt(cost(fit, i));
  Eigen::MatrixXd to_origin = Eigen::MatrixXd::Identity(6, 6);
  to_origin.block<3, 3>(3, 0) = skew(fit.camera_from_world.rotation * fit.centroid);
  return {fit.camera_from_world, to_origin * judged.covariance * to_origin.transpose(),
          std::move(residuals), std::move(found.inliers), judged.verdict};
}

}  // namespace mixrig::estimation
