// SPDX-License-Identifier: Apache-2.0
#include "host/tracking/pose_covariance.h"

#include <algorithm>
#include <array>

#include <Eigen/Dense>

namespace mixrig::tracking {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;
using SixBySix = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kParts = 24;
constexpr int kFewestOfPart = 3;

/// The part of the room in a direction: the longest axis and the signs of all three.
std::size_t part_of_room(const Eigen::Vector3f& direction) {
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  const int signs =
      (direction.x() > 0 ? 1 : 0) + (direction.y() > 0 ? 2 : 0) + (direction.z() > 0 ? 4 : 0);
  return static_cast<std::size_t>(8 * axis + signs);
}

/// Sums over the patches of one part; turns are about the room's origin, in its axes.
struct Part {
  int patches = 0;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< about its turn
  Eigen::Vector3d score = Eigen::Vector3d::Zero();        ///< of its turn
  Matrix63 pull = Matrix63::Zero();                       ///< on the pose, by its turn
};

Eigen::Matrix3d turns_to_shifts(const Eigen::Vector3d& p) {
  Eigen::Matrix3d m;
  m << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0;
  return m;
}

}  // namespace

Eigen::Matrix<double, 6, 6> pose_covariance(std::span<const PatchAlign::Seen> seen,
                                            const geometry::Pose& camera_from_room, double scale) {
  const Eigen::Matrix3d turn = camera_from_room.rotation.toRotationMatrix();
  std::array<Part, kParts> parts;
  SixBySix normal = SixBySix::Zero();
  double squares = 0, weights = 0;
  for (const PatchAlign::Seen& s : seen) {
    if (s.weight <= 0) continue;
    const Eigen::Matrix<double, 6, 2> weighted = s.weight * s.jacobian.transpose() * s.information;
    normal += weighted * s.jacobian;
    squares += s.weight * s.offset.dot(s.information * s.offset), weights += s.weight;
    const Eigen::Matrix<double, 2, 3> by_turn =
        s.jacobian.rightCols<3>() * turn * turns_to_shifts(s.patch->centre_m.cast<double>());
    Part& part = parts[part_of_room(s.patch->centre_m)];
    ++part.patches;
    part.information += s.weight * by_turn.transpose() * s.information * by_turn;
    part.score += s.weight * by_turn.transpose() * s.information * s.offset;
    part.pull += weighted * by_turn;
  }
  const SixBySix inverse = normal.inverse();
  double of_turns = 0, freedom = 0, by_turns = 0;  // squares that turns explain
  SixBySix pulls = SixBySix::Zero();
  for (const Part& part : parts) {
    if (part.patches < kFewestOfPart) continue;
    const Eigen::Matrix3d known =
        part.information + 1e-9 * part.information.trace() * Eigen::Matrix3d::Identity();
    of_turns += part.score.dot(known.ldlt().solve(part.score));
    freedom += 3;
    by_turns += part.information.trace();
    pulls += part.pull * part.pull.transpose();
  }
  const double rest = 2 * weights - freedom;
  const double own = rest > 0 ? std::max(1.0, (squares - of_turns) / rest) : scale * scale;
  by_turns -= (inverse * pulls).trace();
  const double together =
      by_turns > 0 ? std::max(0.0, of_turns - own * (freedom - 6)) / by_turns : 0;
  return inverse * (own * normal + together * pulls) * inverse;
}

}  // namespace mixrig::tracking
