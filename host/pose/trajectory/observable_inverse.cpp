// SPDX-License-Identifier: Apache-2.0
#include "host/pose/trajectory/observable_inverse.h"

#include "host/math/estimation/decompositions.h"

namespace mixrig::trajectory {

Eigen::MatrixXd observable_inverse(const Eigen::MatrixXd& hessian, int lever) {
  Eigen::VectorXd diagonal = hessian.diagonal().cwiseMax(1e-300);
  diagonal.segment<3>(lever).setConstant(diagonal.segment<3>(lever).maxCoeff());
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = scale.asDiagonal() * hessian * scale.asDiagonal();
  const estimation::DenseSpectrum spectrum = estimation::dense_spectrum_of(unit);
  constexpr double kUnobservable = 1e-7;
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(hessian.rows());
  for (Eigen::Index i = 0; i < inverse.size(); ++i)
    if (spectrum.values[i] > kUnobservable) inverse[i] = 1 / spectrum.values[i];
  const Eigen::MatrixXd axes = scale.asDiagonal() * spectrum.axes;
  return (axes * inverse.asDiagonal()).lazyProduct(axes.transpose());
}

}  // namespace mixrig::trajectory
