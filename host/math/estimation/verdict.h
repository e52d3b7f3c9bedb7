// SPDX-License-Identifier: Apache-2.0
// Result of every estimator: a value, its covariance, and a verdict whether the data determine it
// at all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/pose.h"

namespace mixrig::estimation {

enum class Standing {
  kOk,         ///< value and covariance hold in every direction
  kWeak,       ///< they hold, but one direction is far less certain than the rest
  kDegenerate  ///< the data do not determine an answer; the value means nothing
};

/// Verdict of an estimator: ok, weak(direction, sigma) or degenerate(reason).
struct Verdict {
  Standing standing = Standing::kDegenerate;
  std::string reason;         ///< one line, empty for ok
  Eigen::VectorXd direction;  ///< weak: unit vector in the error parameters of the estimate
  double sigma = 0;           ///< weak: direction * sigma is the one-sigma step of the worst error

  static Verdict ok() { return {Standing::kOk, {}, {}, 0}; }
  static Verdict weak(Eigen::VectorXd direction, double sigma, std::string reason) {
    return {Standing::kWeak, std::move(reason), std::move(direction), sigma};
  }
  static Verdict degenerate(std::string reason) {
    return {Standing::kDegenerate, std::move(reason), {}, 0};
  }
};

/// "ok", "weak" or "degenerate".
const char* name_of(Standing standing);

/// An estimate with its covariance and verdict. Where the verdict is degenerate, `value` is the
/// default value, `covariance` is empty and `verdict.reason` says why.
template <typename T>
struct Estimate {
  T value{};
  Eigen::MatrixXd covariance;  ///< over the estimator's error parameters, which it documents
  Eigen::VectorXd residuals;   ///< one or more per measurement, outliers included, in its unit
  std::vector<int> inliers;    ///< indices of the measurements that were used
  Verdict verdict;

  bool usable() const { return verdict.standing != Standing::kDegenerate; }
  static Estimate degenerate(std::string reason) {
    Estimate refused;
    refused.verdict = Verdict::degenerate(std::move(reason));
    return refused;
  }
};

/// Covariance and verdict of a least-squares fit.
struct Judgement {
  Eigen::MatrixXd covariance;
  Verdict verdict;
};

/// A fit is weak if the sigma of its worst direction is at least this multiple of the sigma that
/// the same information, spread evenly over all directions, would give.
inline constexpr double kWeakRatio = 5.0;
/// An estimate whose sigma exceeds this share of the scene's own extent is degenerate.
inline constexpr double kDegenerateShare = 0.25;

/// Judges the information matrix (J^T J of whitened residuals) of a fit. `extent` makes the
/// parameters comparable: the size of the scene in each (1 rad for rotations, m for positions).
Judgement judge(const Eigen::MatrixXd& information, const Eigen::VectorXd& extent,
                double degenerate_share = kDegenerateShare);

/// Upper limit of chi-squared with `dof` degrees of freedom at `z` standard normal deviations
/// (Wilson and Hilferty 1931; within 3 % for z in 0..4).
double chi2_limit(int dof, double z);
/// z of the test that one measurement belongs to the fit (p = 0.0013).
inline constexpr double kInlierZ = 3.0;
/// z of the test that a whole fit agrees with the stated noise (p = 5e-5).
inline constexpr double kFitZ = 3.9;

/// Returns the stated sigma, else one estimated from the residuals (at least `rounding`, the
/// rounding error of the input); nullopt without redundancy.
std::optional<double> noise_sigma(std::optional<double> stated, double squared_sum, int dof,
                                  double rounding);

/// Returns the error of a pose against another in the parameters of all pose covariances: rotation
/// vector w (rad), then translation (m), with rotation = exp(w) * reference.rotation.
Eigen::Matrix<double, 6, 1> pose_error(const geometry::Pose& pose, const geometry::Pose& reference);
/// Rotation vector of a rotation, angle in 0..pi.
Eigen::Vector3d rotation_log(const Eigen::Quaterniond& rotation);
/// Rotation that a rotation vector describes.
Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& w_rad);
/// The cross-product matrix: skew(a) b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

}  // namespace mixrig::estimation
