// SPDX-License-Identifier: Apache-2.0
// Linear least squares of any size, compiled once: Eigen's QR takes long to compile.
#pragma once

#include <Eigen/Core>

namespace mixrig::estimation {

/// Minimises |a x - b| by QR with column pivoting.
struct LinearFit {
  Eigen::VectorXd x;
  Eigen::Index rank;
};
LinearFit solve_linear(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
/// Minimises |a x - b| for each column of b; returns the solutions as columns.
Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace mixrig::estimation
