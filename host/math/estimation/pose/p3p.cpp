// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/p3p.h"

#include <cmath>

#include <Eigen/Dense>

#include "host/math/estimation/points/rigid_fit.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;

/// Sides opposite to points 0, 1, 2 (squared) and cosines of the angles that they subtend.
struct Triangle {
  double a2, b2, c2;
  double cos_alpha, cos_beta, cos_gamma;
};

/// Coefficients of the quartic in v = distance 2 / distance 0, constant term first.
std::array<double, 5> quartic_of(const Triangle& t) {
  const double q = (t.a2 - t.c2) / t.b2, p = (t.a2 + t.c2) / t.b2;
  const double ca = t.cos_alpha, cb = t.cos_beta, cg = t.cos_gamma;
  return {(1 + q) * (1 + q) - 4 * t.a2 / t.b2 * cg * cg,
          4 * (-q * (1 + q) * cb + 2 * t.a2 / t.b2 * cg * cg * cb - (1 - p) * ca * cg),
          2 * (q * q - 1 + 2 * q * q * cb * cb + 2 * (t.b2 - t.c2) / t.b2 * ca * ca -
               4 * p * ca * cb * cg + 2 * (t.b2 - t.a2) / t.b2 * cg * cg),
          4 * (q * (1 - q) * cb - (1 - p) * ca * cg + 2 * t.c2 / t.b2 * ca * ca * cb),
          (q - 1) * (q - 1) - 4 * t.c2 / t.b2 * ca * ca};
}

/// Real parts of the roots that are real to within `tolerance` (double roots split in pairs).
std::vector<double> real_roots(const std::array<double, 5>& k) {
  constexpr double kTolerance = 1e-3;
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  companion.bottomLeftCorner<3, 3>().setIdentity();
  for (int i = 0; i < 4; ++i) companion(i, 3) = -k[i] / k[4];
  if (!companion.allFinite()) return {};
  std::vector<double> roots;
  const Eigen::Vector4cd values = companion.eigenvalues();
  for (int i = 0; i < 4; ++i)
    if (std::abs(values[i].imag()) < kTolerance * std::abs(values[i]))
      roots.push_back(values[i].real());
  return roots;
}

/// Newton steps on the three cosine laws.
Vector3d sharpen(const Triangle& t, Vector3d s) {
  for (int step = 0; step < 8; ++step) {
    const Vector3d residual(s[1] * s[1] + s[2] * s[2] - 2 * s[1] * s[2] * t.cos_alpha - t.a2,
                            s[0] * s[0] + s[2] * s[2] - 2 * s[0] * s[2] * t.cos_beta - t.b2,
                            s[0] * s[0] + s[1] * s[1] - 2 * s[0] * s[1] * t.cos_gamma - t.c2);
    Eigen::Matrix3d j;
    j << 0, 2 * (s[1] - s[2] * t.cos_alpha), 2 * (s[2] - s[1] * t.cos_alpha),
        2 * (s[0] - s[2] * t.cos_beta), 0, 2 * (s[2] - s[0] * t.cos_beta),
        2 * (s[0] - s[1] * t.cos_gamma), 2 * (s[1] - s[0] * t.cos_gamma), 0;
    const Vector3d delta = j.fullPivLu().solve(residual);
    if (!delta.allFinite()) break;
    s -= delta;
    if (delta.norm() < 1e-15 * s.norm()) break;
  }
  return s;
}

}  // namespace

std::vector<geometry::Pose> solve_p3p(const std::array<Vector3d, 3>& points_m,
                                      const std::array<Vector3d, 3>& directions) {
  const auto& [p0, p1, p2] = points_m;
  const auto& [d0, d1, d2] = directions;
  const Triangle t{(p1 - p2).squaredNorm(),
                   (p0 - p2).squaredNorm(),
                   (p0 - p1).squaredNorm(),
                   d1.dot(d2),
                   d0.dot(d2),
                   d0.dot(d1)};
  const double area2 = (p1 - p0).cross(p2 - p0).norm();
  if (!(area2 > 1e-9 * std::max({t.a2, t.b2, t.c2}))) return {};
  const double q = (t.a2 - t.c2) / t.b2;
  constexpr int kAll[] = {0, 1, 2};
  std::vector<geometry::Pose> poses;
  for (double v : real_roots(quartic_of(t))) {
    const double u =
        ((q - 1) * v * v - 2 * q * t.cos_beta * v + 1 + q) / (2 * (t.cos_gamma - v * t.cos_alpha));
    const double s0 = std::sqrt(t.b2 / (1 + v * v - 2 * v * t.cos_beta));
    const Vector3d s = sharpen(t, s0 * Vector3d(1, u, v));
    if (!s.allFinite() || !(s.minCoeff() > 0)) continue;
    const std::array<Vector3d, 3> in_camera = {s[0] * d0, s[1] * d1, s[2] * d2};
    if (const auto pose = align_points(points_m, in_camera, kAll)) poses.push_back(*pose);
  }
  return poses;
}

}  // namespace mixrig::estimation
