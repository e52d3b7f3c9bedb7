// SPDX-License-Identifier: Apache-2.0
// One camera and its views of a board: all parameters at once, by Ceres with our own derivatives.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/any_camera.h"
#include "host/math/geometry/pose.h"

namespace mixrig::calibration {

/// A rotation vector (rad) and a translation (m): p_camera = R(w) p_board + t.
using PoseVector = Eigen::Matrix<double, 6, 1>;
geometry::Pose pose_of(const PoseVector& v);
PoseVector vector_of(const geometry::Pose& pose);

struct BundleView {
  std::vector<Eigen::Vector3d> points_m;  ///< on the board
  std::vector<Eigen::Vector2d> px;
  std::vector<char> used;  ///< 1 for each point that takes part, 0 for one that is left out
  PoseVector camera_from_board;
};

struct Bundle {
  geometry::LensKind kind = geometry::LensKind::kPinhole;
  Eigen::VectorXd intrinsics;
  std::vector<int> free;  ///< indices of the intrinsics to solve for; empty: poses alone
  std::vector<BundleView> views;
};

/// When solve() stops: kFull at full precision; kRough once a step changes the sum of squares by
/// less than 1e-4 of it, enough to find which of two cameras fits a view.
enum class Precision { kFull, kRough };

/// Solves in place for the free intrinsics and every pose. Residuals beyond `huber_px` count
/// linearly (0: all squared). False where it fails: not finite, or a point behind the camera.
bool solve(Bundle& bundle, double huber_px, Precision precision = Precision::kFull);

/// Observed minus projected, px; nullopt where a point has no pixel.
std::optional<Eigen::Vector2d> residual(const Bundle& bundle, const BundleView& view,
                                        std::size_t i);

/// Sum of squared residuals (px^2) over the points in use, and their number.
struct Misfit {
  double squares = 0;
  int points = 0;
  double rms_px() const;  ///< root mean square distance
};
Misfit misfit(const Bundle& bundle, const BundleView& view);
Misfit misfit(const Bundle& bundle);

/// J^T J of the points in use, for noise of 1 px. Columns: the free intrinsics, then six for each
/// view.
Eigen::MatrixXd information(const Bundle& bundle);

/// Derivative of R(w) p + t by (w, t) at a pose.
Eigen::Matrix<double, 3, 6> pose_jacobian(const PoseVector& pose, const Eigen::Vector3d& p);

}  // namespace mixrig::calibration
