// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/pose_covariance.h"

#include <algorithm>
#include <array>
#include <limits>

#include <Eigen/Core>

#include "host/math/geometry/linear.h"

namespace mixrig::tracking {
namespace {

using SixBySix = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kParts = 24;
constexpr int kFewestOfPart = 3;
/// Variance of the shared errors over what the means of the 24 parts show: views meet inside of
/// parts, where their errors cancel in the mean. Chosen for as many views as parts.
constexpr double kHiddenInParts = 2;

/// Returns the part of the room in a direction, by its longest axis and the signs of all three.
std::size_t part_of_room(const Eigen::Vector3f& direction) {
  int axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  const int signs =
      (direction.x() > 0 ? 1 : 0) + (direction.y() > 0 ? 2 : 0) + (direction.z() > 0 ? 4 : 0);
  return static_cast<std::size_t>(8 * axis + signs);
}

/// Returns s^T A^-1 s.
double squared_in_sigmas(const Eigen::Vector3d& s, const Eigen::Matrix3d& a) {
  return s.dot(geometry::SymmetricSolver<3>(a).solve(s));
}

double squared_in_sigmas(const Eigen::Matrix<double, 1, 1>& s,
                         const Eigen::Matrix<double, 1, 1>& a) {
  return a.value() > std::numeric_limits<double>::min() ? s.value() * (s.value() / a.value()) : 0;
}

/// An error of N parameters that the patches of a part of the room share.
template <int N>
class CommonError {
 public:
  /// Adds a patch; `by_error` is the derivative of its offset by the error.
  void add(const PatchAlign::Seen& s, const Eigen::Matrix<double, 2, N>& by_error) {
    const Eigen::Matrix<double, N, 2> weighted = s.weight * by_error.transpose() * s.information;
    Part& part = parts_[part_of_room(s.patch->centre_m)];
    ++part.patches;
    part.information += weighted * by_error;
    part.score += weighted * s.offset;
    part.pull += s.jacobian.transpose() * weighted.transpose();
  }
  /// Sums over the parts; `inverse` is that of the pose's normal equations.
  void finish(const SixBySix& inverse) {
    for (const Part& part : parts_) {
      if (part.patches < kFewestOfPart) continue;
      const Eigen::Matrix<double, N, N> known =
          part.information +
          1e-9 * part.information.trace() * Eigen::Matrix<double, N, N>::Identity();
      squares += squared_in_sigmas(part.score, known);
      freedom += N;
      by_variance_ += part.information.trace();
      pulls_ += part.pull * part.pull.transpose();
    }
    by_variance_ -= (inverse * pulls_).trace();
  }
  /// Returns the covariance of the right side of the normal equations that the shared errors cause,
  /// if patches also have independent errors of variance `own`.
  SixBySix covariance(double own) const {
    if (!(by_variance_ > 0)) return SixBySix::Zero();
    const double shared = squares - own * std::max(0.0, freedom - 6);
    return kHiddenInParts * std::max(0.0, shared) / by_variance_ * pulls_;
  }
  /// Squares and degrees of freedom of the offsets that the shared errors explain.
  double squares = 0, freedom = 0;

 private:
  struct Part {
    int patches = 0;
    Eigen::Matrix<double, N, N> information = Eigen::Matrix<double, N, N>::Zero();
    Eigen::Matrix<double, N, 1> score = Eigen::Matrix<double, N, 1>::Zero();
    /// Derivative of the right side of the pose's normal equations by the error.
    Eigen::Matrix<double, 6, N> pull = Eigen::Matrix<double, 6, N>::Zero();
  };
  std::array<Part, kParts> parts_{};
  double by_variance_ = 0;
  SixBySix pulls_ = SixBySix::Zero();
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
  CommonError<3> turns;
  CommonError<1> stretch;
  SixBySix normal = SixBySix::Zero();
  double squares = 0, weights = 0;
  for (const PatchAlign::Seen& s : seen) {
    if (s.weight <= 0) continue;
    normal += s.weight * s.jacobian.transpose() * s.information * s.jacobian;
    squares += s.weight * s.offset.dot(s.information * s.offset), weights += s.weight;
    const Eigen::Vector3d place = s.patch->centre_m.cast<double>();
    const Eigen::Matrix<double, 2, 3> by_place = s.jacobian.rightCols<3>() * turn;
    turns.add(s, by_place * turns_to_shifts(place));
    stretch.add(s, by_place * place);
  }
  const SixBySix inverse = geometry::inverse_of(normal);
  turns.finish(inverse), stretch.finish(inverse);
  const double rest = 2 * weights - turns.freedom;
  const double own = rest > 0 ? std::max(1.0, (squares - turns.squares) / rest) : scale * scale;
  return inverse * (own * normal + turns.covariance(own) + stretch.covariance(own)) * inverse;
}

}  // namespace mixrig::tracking
