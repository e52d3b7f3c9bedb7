// SPDX-License-Identifier: Apache-2.0
#include "host/sync/told_inverse.h"

#include <Eigen/Eigenvalues>

namespace mixrig::sync {

Eigen::MatrixXd inverse_of_told(const Eigen::MatrixXd& hessian, int lever) {
  Eigen::VectorXd diagonal = hessian.diagonal().cwiseMax(1e-300);
  diagonal.segment<3>(lever).setConstant(diagonal.segment<3>(lever).maxCoeff());
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = scale.asDiagonal() * hessian * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(unit);
  constexpr double kUntold = 1e-7;
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(hessian.rows());
  for (Eigen::Index i = 0; i < inverse.size(); ++i)
    if (solver.eigenvalues()[i] > kUntold) inverse[i] = 1 / solver.eigenvalues()[i];
  const Eigen::MatrixXd axes = scale.asDiagonal() * solver.eigenvectors();
  return axes * inverse.asDiagonal() * axes.transpose();
}

}  // namespace mixrig::sync
