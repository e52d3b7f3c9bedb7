// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/plane_fit.h"

#include <cmath>

#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using Points = std::span<const Vector3d>;

/// Plane, moments of its points (variances from thinnest to widest) and principal axes.
struct PlaneMoments {
  PlaneFit fit;
  Vector3d variance_m2;
  double count;
};

std::optional<PlaneMoments> solve(Points points, std::span<const int> indices) {
  std::vector<Vector3d> chosen;
  for (int i : indices) chosen.push_back(points[i]);
  const auto plane = geometry::fit_plane(chosen);
  if (!plane) return std::nullopt;
  Vector3d centroid = Vector3d::Zero();
  for (const Vector3d& p : chosen) centroid += p - chosen[0];
  const double count = static_cast<double>(chosen.size());
  centroid = chosen[0] + centroid / count;
  // Moments about the plane's own axes: the smallest one loses no precision.
  const Vector3d u = plane->normal.unitOrthogonal(), v = plane->normal.cross(u);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  double thickness = 0;
  for (const Vector3d& p : chosen) {
    const Eigen::Vector2d at(u.dot(p - centroid), v.dot(p - centroid));
    scatter += at * at.transpose();
    thickness += std::pow(plane->normal.dot(p - centroid), 2);
  }
  const PlanarSpectrum spectrum = planar_spectrum_of(scatter / count);
  PlaneMoments moments{
      {*plane, centroid, {}}, {thickness / count, spectrum.values[0], spectrum.values[1]}, count};
  const Eigen::Vector2d wide = spectrum.axes.col(1);
  moments.fit.tangents.col(0) = wide.x() * u + wide.y() * v;
  moments.fit.tangents.col(1) = plane->normal.cross(moments.fit.tangents.col(0));
  return moments;
}

double distance_m(const PlaneMoments& moments, const Vector3d& p) {
  return moments.fit.plane.normal.dot(p - moments.fit.centroid_m);
}

/// Returns the information of (tilt to tangent 0, tilt to tangent 1, offset at the centroid).
Eigen::Matrix3d information_of(const PlaneMoments& moments, double sigma_m) {
  // Perturbation of an eigenvector: the part of the spread that is noise holds no information.
  const double noise = sigma_m * sigma_m;
  const auto tilt = [&](double spread) {
    const double net = std::max(spread - noise, 0.0);
    return moments.count * net * net / (spread * noise);
  };
  return Vector3d(tilt(moments.variance_m2[2]), tilt(moments.variance_m2[1]), moments.count / noise)
      .asDiagonal();
}

}  // namespace

Estimate<PlaneFit> fit_plane_robust(Points points_m, std::optional<double> sigma_m) {
  using Answer = Estimate<PlaneFit>;
  const int n = static_cast<int>(points_m.size());
  if (n < 3 || (n == 3 && !sigma_m))
    return Answer::degenerate("fewer than 3 points (4 where their noise is not stated)");
  if (sigma_m && !(*sigma_m > 0)) return Answer::degenerate("the stated noise must be positive");
  for (int i = 0; i < n; ++i)
    if (!points_m[i].allFinite())
      return Answer::degenerate("point " + std::to_string(i) + " is not finite");
  const double unit = sigma_m ? 1.0 / *sigma_m : 1.0;
  const auto fit = [&](std::span<const int> indices) { return solve(points_m, indices); };
  const auto sample = [&](std::span<const int> indices) {
    const auto moments = solve(points_m, indices);
    return moments ? std::vector<PlaneMoments>{*moments} : std::vector<PlaneMoments>{};
  };
  const auto cost = [&](const PlaneMoments& moments, int i) {
    return std::pow(unit * distance_m(moments, points_m[i]), 2);
  };
  auto found =
      fit_with_consensus<PlaneMoments>({n, 3, 1, 3}, sigma_m.has_value(), fit, sample, cost);
  if (!found.model)
    return Answer::degenerate(sigma_m ? found.reason + ", or they lie on one line"
                                      : "the points lie on one line or coincide");
  const PlaneMoments& moments = *found.model;
  const auto sigma =
      noise_sigma(sigma_m, found.cost, static_cast<int>(found.inliers.size()) - 3,
                  1e-15 * (moments.fit.centroid_m.norm() + std::sqrt(moments.variance_m2[2])));
  if (!sigma) return Answer::degenerate("too few points to estimate their noise: state it");
  if (std::sqrt(moments.variance_m2[1]) < 5 * *sigma)
    return Answer::degenerate("the points lie on one line to within their noise");
  const auto judged =
      judge(information_of(moments, *sigma), Vector3d(1, 1, std::sqrt(moments.variance_m2[2])));
  if (judged.verdict.standing == Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Eigen::VectorXd residuals(n);
  for (int i = 0; i < n; ++i) residuals[i] = distance_m(moments, points_m[i]);
  return {moments.fit, judged.covariance, std::move(residuals), std::move(found.inliers),
          judged.verdict};
}

}  // namespace mixrig::estimation
