// SPDX-License-Identifier: Apache-2.0
// Small dense non-linear least squares: Ceres' TinySolver with automatic derivatives.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

namespace mixrig::estimation::detail {

/// Minimises the residuals of `functor` (operator()(const T* x, T* r) and NumResiduals()) from
/// x = 0; parameters should be of order one. Holds x, residuals and Jacobian at the minimum,
/// not finite where the start lies outside the functor's domain.
template <int kParameters, typename Functor>
class SmallSolution {
 public:
  using Parameters = Eigen::Matrix<double, kParameters, 1>;
  Parameters x = Parameters::Zero();
  Eigen::VectorXd residuals;
  Eigen::Matrix<double, Eigen::Dynamic, kParameters> jacobian;

  explicit SmallSolution(const Functor& functor) : function_(functor) {
    residuals.resize(functor.NumResiduals());
    jacobian.resize(functor.NumResiduals(), kParameters);
    ceres::TinySolver<Function> solver;
    solver.options.gradient_tolerance = 1e-14;
    solver.options.parameter_tolerance = 1e-12;
    solver.options.function_tolerance = 1e-20;
    solver.options.cost_threshold = 1e-28;
    solver.Solve(function_, &x);
    polish();
  }

  bool finite() const { return x.allFinite() && residuals.allFinite() && jacobian.allFinite(); }
  double cost() const { return residuals.squaredNorm(); }
  Eigen::MatrixXd information() const { return jacobian.transpose() * jacobian; }

 private:
  using Function = ceres::TinySolverAutoDiffFunction<Functor, Eigen::Dynamic, kParameters>;

  /// TinySolver squares the condition number; Gauss-Newton steps by QR win the digits back.
  void polish() {
    evaluate();
    for (int step = 0; step < 3 && finite(); ++step) {
      const Parameters before = x;
      const double cost_before = cost();
      x -= jacobian.colPivHouseholderQr().solve(residuals);
      evaluate();
      if (finite() && cost() <= cost_before) continue;
      x = before;
      evaluate();
      return;
    }
  }
  void evaluate() { function_(x.data(), residuals.data(), jacobian.data()); }

  Function function_;
};

}  // namespace mixrig::estimation::detail
