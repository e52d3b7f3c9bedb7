// SPDX-License-Identifier: Apache-2.0
#include "host/trajectory/observable_inverse.h"

#include <Eigen/Eigenvalues>

namespace mixrig::trajectory {

Eigen::MatrixXd observable_inverse(const Eigen::MatrixXd& hessian, int lever) {
  Eigen::VectorXd diagonal = hessian.diagonal().cwiseMax(1e-300);
  diagonal.segment<3>(lever).setConstant(diagonal.segment<3>(lever).maxCoeff());
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = scale.asDiagonal() * hessian * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(unit);
  constexpr double kUnobservable = 1e-7;
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(hessian.rows());
  for (Eigen::Index i = 0; i < inverse.size(); ++i)
    if (solver.eigenvalues()[i] > kUnobservable) inverse[i] = 1 / solver.eigenvalues()[i];
  const Eigen::MatrixXd axes = scale.asDiagonal() * solver.eigenvectors();
  return axes * inverse.asDiagonal() * axes.transpose();
}

}  // namespace mixrig::trajectory
