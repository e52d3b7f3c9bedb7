// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/views/two_view.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "extras/map/reconstruction/views/five_point.h"
#include "extras/map/reconstruction/views/sampler.h"
#include "hal/base/order_statistics.h"
#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::reconstruction {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kFewestPairs = 15;
constexpr double kLeastShare = 0.4;
constexpr double kLimit = 3 * 3;  ///< squared sigmas

/// Squared distance of ray b to the plane that E spans with ray a, in sigmas.
double plane_cost(const Matrix3d& e, const RayPair& pair) {
  const Vector3d normal = e * pair.a.direction;
  const double length = normal.norm();
  if (!(length > 1e-12)) return kLimit;
  const Vector3d off = (normal.dot(pair.b.direction) / (length * length)) * normal;
  return (pair.b.whitener * off).squaredNorm();
}

/// Squared error of ray b by a rotation alone, in sigmas.
double turn_cost(const Matrix3d& rotation, const RayPair& pair) {
  return (pair.b.whitener * (rotation * pair.a.direction - pair.b.direction)).squaredNorm();
}

/// The rotation that most pairs agree with, by reweighted least squares.
Matrix3d best_turn(std::span<const RayPair> pairs, std::span<const int> indices) {
  Matrix3d rotation = Matrix3d::Identity();
  std::vector<double> weights(indices.size(), 1);
  constexpr int kRounds = 12;
  for (int round = 0; round < kRounds; ++round) {
    Matrix3d cross = Matrix3d::Zero();
    for (std::size_t k = 0; k < indices.size(); ++k) {
      const RayPair& pair = pairs[static_cast<std::size_t>(indices[k])];
      cross += weights[k] * pair.b.direction * pair.a.direction.transpose();
    }
    rotation = estimation::fit_rotation(cross).rotation.toRotationMatrix();
    for (std::size_t k = 0; k < indices.size(); ++k)
      weights[k] =
          1 / std::sqrt(1 + turn_cost(rotation, pairs[static_cast<std::size_t>(indices[k])]));
  }
  return rotation;
}

/// Distances along both rays to where they come nearest; false where they are parallel.
bool in_front(const geometry::Pose& b_from_a, const RayPair& pair) {
  const Vector3d a = b_from_a.rotation * pair.a.direction, &b = pair.b.direction;
  const Vector3d& t = b_from_a.translation_m;
  const double ab = a.dot(b), det = 1 - ab * ab;
  if (det < 1e-12) return false;
  // z_a a + t = z_b b in the least-squares sense.
  const double z_a = (ab * b.dot(t) - a.dot(t)) / det, z_b = (b.dot(t) - ab * a.dot(t)) / det;
  return z_a > 0 && z_b > 0;
}

/// The motion with most places in front of both cameras, among the four of an essential matrix.
geometry::Pose motion_of(const Matrix3d& e, std::span<const RayPair> pairs,
                         std::span<const int> inliers) {
  const estimation::SingularValues svd = estimation::singular_values_of(e);
  Matrix3d u = svd.u, v = svd.v, w;
  if (u.determinant() < 0) u = -u;
  if (v.determinant() < 0) v = -v;
  w << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  geometry::Pose best;
  std::ptrdiff_t most = -1;
  for (const Matrix3d& r :
       {Matrix3d(u * w * v.transpose()), Matrix3d(u * w.transpose() * v.transpose())})
    for (const double sign : {1.0, -1.0}) {
      const geometry::Pose pose{Eigen::Quaterniond(r), sign * u.col(2)};
      const auto count = std::count_if(inliers.begin(), inliers.end(), [&](int i) {
        return in_front(pose, pairs[static_cast<std::size_t>(i)]);
      });
      if (count > most) most = count, best = pose;
    }
  return best;
}

std::optional<Matrix3d> best_essential(std::span<const RayPair> pairs, int trials) {
  const int n = static_cast<int>(pairs.size());
  estimation::BestModel<Matrix3d> best(n, kLimit);
  Sampler sampler(n);
  std::array<int, 5> sample{};
  for (int trial = 0; trial < trials; ++trial) {
    sampler.draw(sample);
    std::array<Vector3d, 5> a, b;
    for (std::size_t k = 0; k < 5; ++k) {
      a[k] = pairs[static_cast<std::size_t>(sample[k])].a.direction;
      b[k] = pairs[static_cast<std::size_t>(sample[k])].b.direction;
    }
    for (const Matrix3d& e : essential_of_five(a, b))
      best.offer(e, [&](const Matrix3d& m, int i) {
        return plane_cost(m, pairs[static_cast<std::size_t>(i)]);
      });
    if (std::pow(1 - std::pow(best.share(), 5), trial) < 1e-6) break;
  }
  return best.model();
}

}  // namespace

std::optional<TwoViews> relate_views(std::span<const RayPair> pairs, int trials) {
  if (pairs.size() < kFewestPairs) return std::nullopt;
  const auto e = best_essential(pairs, trials);
  if (!e) return std::nullopt;
  std::vector<int> agreeing;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (plane_cost(*e, pairs[i]) < kLimit) agreeing.push_back(static_cast<int>(i));
  TwoViews views;
  views.b_from_a = motion_of(*e, pairs, agreeing);
  for (const int i : agreeing)
    if (in_front(views.b_from_a, pairs[static_cast<std::size_t>(i)])) views.inliers.push_back(i);
  const Matrix3d turn = best_turn(pairs, agreeing);
  std::vector<double> angles;
  for (const int i : agreeing) {
    const RayPair& pair = pairs[static_cast<std::size_t>(i)];
    angles.push_back((turn * pair.a.direction).cross(pair.b.direction).norm());
  }
  views.parallax_rad = median_in_place(std::span<double>(angles));
  if (agreeing.size() < kFewestPairs ||
      static_cast<double>(agreeing.size()) < kLeastShare * static_cast<double>(pairs.size()))
    return std::nullopt;
  const auto turned = std::count_if(agreeing.begin(), agreeing.end(), [&](int i) {
    return turn_cost(turn, pairs[static_cast<std::size_t>(i)]) < kLimit;
  });
  views.turned_share = static_cast<double>(turned) / static_cast<double>(agreeing.size());
  return views;
}

}  // namespace mixrig::reconstruction
