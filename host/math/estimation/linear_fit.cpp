// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/linear_fit.h"

#include <Eigen/QR>

namespace mixrig::estimation {

LinearFit solve_linear(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  return {qr.solve(b), qr.rank()};
}

Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

}  // namespace mixrig::estimation
