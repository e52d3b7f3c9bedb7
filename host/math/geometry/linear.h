// SPDX-License-Identifier: Apache-2.0
// Solves small linear systems. Compiled once, since each file that uses Eigen's decompositions
// takes seconds to compile.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mixrig::geometry {

/// Solves A x = b for a symmetric A by LDL^T with pivoting; not finite where A is singular.
/// Compiled for N of 3 and 6; estimation::SymmetricSolver takes any size.
template <int N>
class SymmetricSolver {
 public:
  using Square = Eigen::Matrix<double, N, N>;
  using Column = Eigen::Matrix<double, N, 1>;

  explicit SymmetricSolver(const Square& symmetric);
  Column solve(const Column& b) const;
  Square inverse() const;
  bool is_solved() const { return ldlt_.info() == Eigen::Success; }
  bool is_positive() const { return ldlt_.isPositive(); }
  /// Least element of D; -1 where A could not be factorised.
  double least_pivot() const;
  /// Estimate of the reciprocal of the condition number.
  double reciprocal_condition() const;

 private:
  Eigen::LDLT<Square> ldlt_;
};
extern template class SymmetricSolver<3>;
extern template class SymmetricSolver<6>;

using Column6 = Eigen::Matrix<double, 6, 1>;
using Square6 = Eigen::Matrix<double, 6, 6>;

/// Cholesky factor L of A = L L^T, for a symmetric positive definite A.
class Cholesky6 {
 public:
  explicit Cholesky6(const Square6& symmetric);
  bool is_positive() const { return llt_.info() == Eigen::Success; }
  Column6 solve(const Column6& b) const;
  Square6 root() const;

 private:
  Eigen::LLT<Square6> llt_;
};

/// Returns the inverse by LU with partial pivoting.
Square6 inverse_of(const Square6& a);

/// Returns the shortest rotation from the direction of `from` to that of `to`; about some axis if
/// they are opposite.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace mixrig::geometry
