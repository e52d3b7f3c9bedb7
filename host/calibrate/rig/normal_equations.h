// SPDX-License-Identifier: Apache-2.0
// Least squares over parameters that all views share and six more a view, by Levenberg-Marquardt
// with the views' poses eliminated (Schur complement).
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "hal/base/parallel.h"
#include "host/calibrate/rig/rig_model.h"

namespace mixrig::calibration {

/// J^T J of rows (derivatives, residual), gathered in blocks so that it costs matrix products.
class RowSum {
 public:
  explicit RowSum(int columns);
  /// The next row to fill, zeroed: derivatives, then the residual.
  auto next() {
    if (used_ == kBlock) flush();
    return rows_.col(used_++);
  }
  void flush();
  /// (columns + 1) x (columns + 1), symmetric.
  const Eigen::MatrixXd& sum() {
    flush();
    return sum_;
  }

 private:
  static constexpr int kBlock = 128;
  Eigen::MatrixXd rows_, sum_;
  int used_ = 0;
};

/// Sums of one view. `sum` is symmetric; its columns are the shared parameters, the view's six,
/// then the residual.
struct ViewTerm {
  Eigen::MatrixXd sum;
  long rows = 0;
};
/// Computes the sums of view `view` at a model; called from several threads at once.
using ViewFunction =
    std::function<ViewTerm(const RigModel& model, const RigLayout& layout, int view)>;

struct SolveOptions {
  int most_steps = 30;
  /// Stops where a step is predicted to gain less, in mean squared residuals.
  double least_gain = 1e-3;
  /// Weights of a prior at the start values of shared parameters; may be empty.
  Eigen::VectorXd prior;
};

struct SolveReport {
  double cost = 0;  ///< sum of squares
  long rows = 0;
  int steps = 0;
  bool solved = false;         ///< false where the data do not determine the parameters
  Eigen::MatrixXd covariance;  ///< of the shared parameters, for residuals of unit sigma
  Eigen::VectorXd weakest;     ///< eigenvector of the least certain direction
};

/// Improves `model` in place.
SolveReport solve_views(RigModel& model, const RigLayout& layout, const ViewFunction& term,
                        const std::vector<int>& views, const SolveOptions& options, Crew& crew);

}  // namespace mixrig::calibration
