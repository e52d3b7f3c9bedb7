// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/views/resection.h"

#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "extras/map/reconstruction/views/rays.h"
#include "extras/map/reconstruction/views/sampler.h"
#include "hal/base/order_statistics.h"
#include "host/math/estimation/consensus.h"
#include "host/math/estimation/pose/p3p.h"
#include "host/math/geometry/linear.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Places = std::span<const Vector3d>;
using Rays = std::span<const estimation::Bearing>;

constexpr double kTukey = 4.685, kInlierSigmas = 3;
constexpr std::size_t kFewest = 6;

double distance_of(const geometry::Pose& pose, const Vector3d& place,
                   const estimation::Bearing& ray) {
  const Vector3d p = pose * place;
  // The whitened error of a place straight behind the camera is 0 too.
  if (!(p.dot(ray.direction) > 0)) return 1e9;
  return ray_error<double>(ray, p).norm();
}

/// Scale of the errors in sigmas, at least 1. Where most places lie farther off than their sigma
/// says, it is larger, so that more of them count.
double scale_of(Places places, Rays rays, const geometry::Pose& pose) {
  std::vector<double> distances(places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    distances[i] = distance_of(pose, places[i], rays[i]);
  constexpr double kMedianOfRayleigh = 1.1774, kMost = 10;
  return std::clamp(median_in_place(std::span<double>(distances)) / kMedianOfRayleigh, 1.0, kMost);
}

/// Sums of one step; weights by Tukey's function of the distance.
struct NormalEquations {
  Matrix6 left = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
};

NormalEquations equations_of(Places places, Rays rays, const geometry::Pose& pose, double scale) {
  NormalEquations sum;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double t = distance_of(pose, places[i], rays[i]) / (kTukey * scale);
    if (!(t < 1)) continue;
    const Vector3d p = pose * places[i];
    const double length = p.norm();
    const Vector3d unit = p / length;
    const Eigen::Matrix<double, 2, 3> by_place =
        rays[i].whitener * (Eigen::Matrix3d::Identity() - unit * unit.transpose()) / length;
    Eigen::Matrix<double, 2, 6> by_pose;
    by_pose << -by_place * estimation::skew(p), by_place;
    const double weight = (1 - t * t) * (1 - t * t);
    sum.left += weight * by_pose.transpose() * by_pose;
    sum.right -= weight * by_pose.transpose() * ray_error<double>(rays[i], p);
  }
  return sum;
}

geometry::Pose moved(const geometry::Pose& pose, const Vector6& by) {
  const Eigen::Quaterniond turn = estimation::rotation_exp(by.head<3>());
  return {(turn * pose.rotation).normalized(), turn * pose.translation_m + by.tail<3>()};
}

}  // namespace

std::optional<Resection> refine_pose(Places places, Rays rays, const geometry::Pose& start) {
  if (places.size() < kFewest || places.size() != rays.size()) return std::nullopt;
  Resection found;
  found.camera_from_map = start;
  constexpr int kRounds = 20;
  constexpr double kStill = 1e-10;
  for (int round = 0; round < kRounds; ++round) {
    const auto sum = equations_of(places, rays, found.camera_from_map,
                                  scale_of(places, rays, found.camera_from_map));
    const geometry::SymmetricSolver<6> solver(sum.left);
    const Vector6 step = solver.solve(sum.right);
    if (!solver.is_solved() || !step.allFinite() || step.head<3>().norm() > 1) return std::nullopt;
    found.camera_from_map = moved(found.camera_from_map, step);
    if (step.squaredNorm() < kStill * kStill) break;
  }
  const double scale = scale_of(places, rays, found.camera_from_map);
  double squares = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double distance = distance_of(found.camera_from_map, places[i], rays[i]);
    if (distance > kInlierSigmas * scale) continue;
    found.inliers.push_back(static_cast<int>(i));
    squares += distance * distance;
  }
  if (found.inliers.size() < kFewest) return std::nullopt;
  found.rms = std::sqrt(squares / (2.0 * static_cast<double>(found.inliers.size())));
  const Eigen::FullPivLU<Matrix6> information(
      equations_of(places, rays, found.camera_from_map, scale).left);
  if (!information.isInvertible()) return std::nullopt;
  found.covariance = scale * scale * information.inverse();
  return found;
}

std::optional<Resection> find_pose(Places places, Rays rays, double limit, int trials) {
  if (places.size() < kFewest || places.size() != rays.size()) return std::nullopt;
  const int n = static_cast<int>(places.size());
  estimation::BestModel<geometry::Pose> best(n, limit * limit);
  Sampler sampler(n);
  std::array<int, 3> sample{};
  for (int trial = 0; trial < trials; ++trial) {
    sampler.draw(sample);
    std::array<Vector3d, 3> points, directions;
    for (std::size_t k = 0; k < 3; ++k) {
      points[k] = places[static_cast<std::size_t>(sample[k])];
      directions[k] = rays[static_cast<std::size_t>(sample[k])].direction;
    }
    for (const geometry::Pose& pose : estimation::solve_p3p(points, directions))
      best.offer(pose, [&](const geometry::Pose& model, int i) {
        const auto at = static_cast<std::size_t>(i);
        const double distance = distance_of(model, places[at], rays[at]);
        return distance * distance;
      });
    if (std::pow(1 - std::pow(best.share(), 3), trial) < 1e-6) break;
  }
  if (!best.model()) return std::nullopt;
  // Outliers must not widen the scale of the refinement: it sees those that agree.
  std::vector<int> kept;
  std::vector<Vector3d> some;
  std::vector<estimation::Bearing> their;
  for (int i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (distance_of(*best.model(), places[at], rays[at]) > 2 * limit) continue;
    kept.push_back(i), some.push_back(places[at]), their.push_back(rays[at]);
  }
  auto found = refine_pose(some, their, *best.model());
  if (found)
    for (int& i : found->inliers) i = kept[static_cast<std::size_t>(i)];
  return found;
}

}  // namespace mixrig::reconstruction
