// SPDX-License-Identifier: Apache-2.0
// Small dense non-linear least squares: Ceres' TinySolver, compiled once, with automatic
// derivatives. Private to this module.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>
#include <ceres/jet.h>

namespace mixrig::estimation::detail {

/// Parameters, residuals and Jacobian at a minimum; not finite where the start lies outside the
/// model's domain.
struct SmallSolution {
  Eigen::VectorXd x, residuals;
  Eigen::MatrixXd jacobian;

  bool finite() const;
  double cost() const;
  Eigen::MatrixXd information() const;  ///< J^T J
};

/// Fills `residuals`, and `jacobian` (column-major) unless it is nullptr, at x.
using SmallModel = std::function<void(const double* x, double* residuals, double* jacobian)>;

/// Minimises from x = 0; parameters should be of order one.
SmallSolution minimise(int parameters, int residuals, const SmallModel& model);

/// Minimises a functor with operator()(const T* x, T* r) and NumResiduals(), from x = 0.
template <int kParameters, typename Functor>
SmallSolution minimise(const Functor& functor) {
  using Jet = ceres::Jet<double, kParameters>;
  const int count = functor.NumResiduals();
  std::vector<Jet> r(count);
  return minimise(kParameters, count, [&](const double* x, double* residuals, double* jacobian) {
    if (!jacobian) {
      functor(x, residuals);
      return;
    }
    Jet at[kParameters];
    for (int k = 0; k < kParameters; ++k) at[k] = Jet(x[k], k);
    functor(static_cast<const Jet*>(at), r.data());
    for (int i = 0; i < count; ++i) {
      residuals[i] = r[i].a;
      for (int k = 0; k < kParameters; ++k) jacobian[k * count + i] = r[i].v[k];
    }
  });
}

}  // namespace mixrig::estimation::detail
