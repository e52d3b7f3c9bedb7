// SPDX-License-Identifier: Apache-2.0
// Small linear systems, compiled once: where a file uses Eigen's decompositions itself, each costs
// it seconds to compile.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mixrig::geometry {

/// Solves A x = b for a symmetric A by LDL^T with pivoting; not finite where A is singular.
/// Compiled for N of 3 and 6; of any size: estimation::SymmetricSolver.
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
  /// Reciprocal of the condition number, about.
  double reciprocal_condition() const;

 private:
  Eigen::LDLT<Square> ldlt_;
};
extern template class SymmetricSolver<3>;
extern template class SymmetricSolver<6>;

using Column6 = Eigen::Matrix<double, 6, 1>;
using Square6 = Eigen::Matrix<double, 6, 6>;

/// L of A = L L^T, for an A that is symmetric and positive.
class Cholesky6 {
 public:
  explicit Cholesky6(const Square6& symmetric);
  bool is_positive() const { return llt_.info() == Eigen::Success; }
  Column6 solve(const Column6& b) const;
  Square6 root() const;

 private:
  Eigen::LLT<Square6> llt_;
};

/// By LU with partial pivoting.
Square6 inverse_of(const Square6& a);

/// The shortest rotation that takes the direction of `from` to that of `to`. About some axis where
/// they are opposite.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace mixrig::geometry
