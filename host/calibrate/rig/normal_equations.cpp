// SPDX-License-Identifier: Apache-2.0
// Levenberg-Marquardt with the views' poses eliminated.
#include "host/calibrate/rig/normal_equations.h"

#include <algorithm>
#include <cmath>

#include "host/math/estimation/decompositions.h"

namespace mixrig::calibration {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

std::vector<ViewTerm> evaluate(const RigModel& model, const RigLayout& layout,
                               const ViewFunction& term, const std::vector<int>& views,
                               Crew& crew) {
  std::vector<ViewTerm> terms(views.size());
  crew.rows(static_cast<int>(views.size()), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) terms[i] = term(model, layout, views[i]);
  });
  return terms;
}

double cost_of(const std::vector<ViewTerm>& terms) {
  double cost = 0;
  for (const ViewTerm& t : terms) cost += t.sum(t.sum.rows() - 1, t.sum.cols() - 1);
  return cost;
}

/// The shared parameters' equations after the poses are eliminated.
struct Reduced {
  Eigen::MatrixXd h;
  Eigen::VectorXd g;
};

Matrix6 pose_inverse(const ViewTerm& t, int shared, double damping) {
  Matrix6 h = t.sum.block<6, 6>(shared, shared);
  h.diagonal() *= 1 + damping;
  h.diagonal().array() += 1e-12 * h.trace() + 1e-30;
  return estimation::SymmetricSolver(h).solve(Matrix6::Identity());
}

Reduced reduce(const std::vector<ViewTerm>& terms, int n, double damping,
               const Eigen::VectorXd& prior) {
  Reduced r{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const ViewTerm& t : terms) {
    r.h += t.sum.topLeftCorner(n, n);
    r.g += t.sum.col(n + 6).head(n);
  }
  r.h.diagonal() *= 1 + damping;
  if (prior.size() == n) r.h.diagonal() += prior;
  for (const ViewTerm& t : terms) {
    const Eigen::MatrixXd cross = t.sum.block(0, n, n, 6);
    const Eigen::MatrixXd by_pose = cross * pose_inverse(t, n, damping);
    r.h -= by_pose * cross.transpose();
    r.g -= by_pose * t.sum.col(n + 6).segment<6>(n);
  }
  return r;
}

/// Minus the step: J^T J x = J^T r, scaled to a unit diagonal before it is solved.
Eigen::VectorXd solve_scaled(const Reduced& r) {
  if (r.g.size() == 0) return {};  // only poses are solved for
  const Eigen::VectorXd scale = r.h.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd h = scale.asDiagonal() * r.h * scale.asDiagonal();
  return scale.asDiagonal() * estimation::SymmetricSolver(h).solve(scale.asDiagonal() * r.g);
}

void judge(const Reduced& r, SolveReport& report) {
  report.solved = true;
  if (r.g.size() == 0) return;
  const Eigen::VectorXd scale = r.h.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd h = scale.asDiagonal() * r.h * scale.asDiagonal();
  const estimation::DenseSpectrum spectrum = estimation::dense_spectrum_of(h);
  report.weakest = spectrum.axes.col(0);
  report.solved = spectrum.values[0] > 1e-12;
  if (!report.solved) return;
  const Eigen::MatrixXd inverse =
      spectrum.axes * spectrum.values.cwiseInverse().asDiagonal() * spectrum.axes.transpose();
  report.covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
}

}  // namespace

RowSum::RowSum(int columns)
    : rows_(Eigen::MatrixXd::Zero(columns + 1, kBlock)),
      sum_(Eigen::MatrixXd::Zero(columns + 1, columns + 1)) {}

void RowSum::flush() {
  if (used_ == 0) return;
  sum_.noalias() += rows_.leftCols(used_) * rows_.leftCols(used_).transpose();
  rows_.leftCols(used_).setZero();
  used_ = 0;
}

SolveReport solve_views(RigModel& model, const RigLayout& layout, const ViewFunction& term,
                        const std::vector<int>& views, const SolveOptions& options, Crew& crew) {
  const int n = layout.count;
  SolveReport report;
  std::vector<ViewTerm> terms = evaluate(model, layout, term, views, crew);
  report.cost = cost_of(terms);
  for (const ViewTerm& t : terms) report.rows += t.rows;
  double damping = 1e-4;
  while (report.steps < options.most_steps) {
    ++report.steps;
    const Reduced reduced = reduce(terms, n, damping, options.prior);
    const Eigen::VectorXd shared = -solve_scaled(reduced);
    std::vector<Vector6> poses(model.target_from_board.size(), Vector6::Zero());
    double promised = -shared.dot(reduced.g);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Vector6 own = terms[i].sum.col(n + 6).segment<6>(n);
      const Vector6 g = own + terms[i].sum.block(0, n, n, 6).transpose() * shared;
      const Matrix6 inverse = pose_inverse(terms[i], n, damping);
      poses[views[i]] = -inverse * g;
      promised += own.dot(inverse * own);
    }
    if (promised <
        options.least_gain * report.cost / static_cast<double>(std::max(report.rows, 1L)))
      break;
    RigModel moved = model;
    apply_step(moved, layout, shared, poses);
    std::vector<ViewTerm> next = evaluate(moved, layout, term, views, crew);
    const double cost = cost_of(next);
    if (!(cost < report.cost)) {  // NaN too
      if (damping > 1e6) break;
      damping *= 8;
      continue;
    }
    model = std::move(moved);
    terms = std::move(next);
    report.cost = cost;
    damping = std::max(1e-9, damping / 5);
  }
  report.rows = 0;
  for (const ViewTerm& t : terms) report.rows += t.rows;
  judge(reduce(terms, n, 0, options.prior), report);
  return report;
}

}  // namespace mixrig::calibration
