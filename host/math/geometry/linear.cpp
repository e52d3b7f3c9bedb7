// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/linear.h"

#include <cmath>
#include <limits>

#include <Eigen/LU>

namespace mixrig::geometry {

template <int N>
SymmetricSolver<N>::SymmetricSolver(const Square& symmetric) : ldlt_(symmetric) {}

template <int N>
auto SymmetricSolver<N>::solve(const Column& b) const -> Column {
  return ldlt_.solve(b);
}

template <int N>
auto SymmetricSolver<N>::inverse() const -> Square {
  return ldlt_.solve(Square::Identity());
}

template <int N>
double SymmetricSolver<N>::least_pivot() const {
  return is_solved() ? ldlt_.vectorD().minCoeff() : -1;
}

template <int N>
double SymmetricSolver<N>::reciprocal_condition() const {
  return ldlt_.rcond();
}

template class SymmetricSolver<3>;
template class SymmetricSolver<6>;

Cholesky6::Cholesky6(const Square6& symmetric) : llt_(symmetric) {}

Column6 Cholesky6::solve(const Column6& b) const { return llt_.solve(b); }

Square6 Cholesky6::root() const { return llt_.matrixL(); }

Square6 inverse_of(const Square6& a) { return a.inverse(); }

// Equals Eigen's FromTwoVectors except for opposite directions, where Eigen uses a singular value
// decomposition.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  if (cosine < -1 + 1e-12) {
    const Eigen::Vector3d axis = a.unitOrthogonal();
    return {0, axis.x(), axis.y(), axis.z()};
  }
  const Eigen::Vector3d axis = a.cross(b);
  const double s = std::sqrt((1 + cosine) * 2), inverse_s = 1 / s;
  const Eigen::Vector3d part = axis * inverse_s;
  return {s * 0.5, part.x(), part.y(), part.z()};
}

}  // namespace mixrig::geometry
