// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/small_solve.h"

#include <ceres/tiny_solver.h>

#include "host/math/estimation/linear_fit.h"

namespace mixrig::estimation::detail {
namespace {

/// A model with the interface that TinySolver requires.
struct TinyFunction {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };
  const SmallModel& model;
  int parameters, residuals;

  int NumResiduals() const { return residuals; }
  int NumParameters() const { return parameters; }
  bool operator()(const double* x, double* r, double* jacobian) const {
    model(x, r, jacobian);
    return true;
  }
};

/// TinySolver squares the condition number; Gauss-Newton steps by QR recover the precision.
void polish(const SmallModel& model, SmallSolution& s) {
  const auto evaluate = [&] { model(s.x.data(), s.residuals.data(), s.jacobian.data()); };
  evaluate();
  for (int step = 0; step < 3 && s.finite(); ++step) {
    const Eigen::VectorXd before = s.x;
    const double cost_before = s.cost();
    s.x -= solve_linear(s.jacobian, s.residuals).x;
    evaluate();
    if (s.finite() && s.cost() <= cost_before) continue;
    s.x = before;
    evaluate();
    return;
  }
}

}  // namespace

bool SmallSolution::finite() const {
  return x.allFinite() && residuals.allFinite() && jacobian.allFinite();
}

double SmallSolution::cost() const { return residuals.squaredNorm(); }

Eigen::MatrixXd SmallSolution::information() const {
  return jacobian.transpose().lazyProduct(jacobian);
}

SmallSolution minimise(int parameters, int residuals, const SmallModel& model) {
  SmallSolution solution{Eigen::VectorXd::Zero(parameters), Eigen::VectorXd(residuals),
                         Eigen::MatrixXd(residuals, parameters)};
  ceres::TinySolver<TinyFunction> solver;
  solver.options.gradient_tolerance = 1e-14;
  solver.options.parameter_tolerance = 1e-12;
  solver.options.function_tolerance = 1e-20;
  solver.options.cost_threshold = 1e-28;
  solver.Solve({model, parameters, residuals}, &solution.x);
  polish(model, solution);
  return solution;
}

}  // namespace mixrig::estimation::detail
