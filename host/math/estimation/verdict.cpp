// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/verdict.h"

#include <cmath>

#include "host/math/estimation/decompositions.h"

namespace mixrig::estimation {

const char* name_of(Standing standing) {
  switch (standing) {
    case Standing::kOk:
      return "ok";
    case Standing::kWeak:
      return "weak";
    case Standing::kDegenerate:
      break;
  }
  return "degenerate";
}

Judgement judge(const Eigen::MatrixXd& information, const Eigen::VectorXd& extent,
                double degenerate_share) {
  const Eigen::MatrixXd relative = extent.asDiagonal() * information * extent.asDiagonal();
  if (!relative.allFinite())
    return {{}, Verdict::degenerate("the information about the estimate is not finite")};
  const DenseSpectrum spectrum = dense_spectrum_of(relative);
  const Eigen::VectorXd& lambda = spectrum.values;
  constexpr double kSingular = 1e-14;  // below, an eigenvalue is rounding
  if (!(lambda[0] > kSingular * lambda[lambda.size() - 1]))
    return {{}, Verdict::degenerate("the data say nothing about one direction of the estimate")};
  const double worst = 1.0 / std::sqrt(lambda[0]);
  if (!(worst < degenerate_share))
    return {
        {},
        Verdict::degenerate("the uncertainty in one direction is as large as the scene itself")};
  const Eigen::MatrixXd axes = extent.asDiagonal() * spectrum.axes;
  Judgement judgement{(axes * lambda.cwiseInverse().asDiagonal()).lazyProduct(axes.transpose()),
                      Verdict::ok()};
  if (worst * std::sqrt(lambda.mean()) > kWeakRatio) {
    const Eigen::VectorXd step = worst * axes.col(0);
    judgement.verdict = Verdict::weak(step.normalized(), step.norm(),
                                      "one direction is far less certain than the others");
  }
  return judgement;
}

double chi2_limit(int dof, double z) {
  const double spread = 2.0 / (9.0 * dof);
  return dof * std::pow(1.0 - spread + z * std::sqrt(spread), 3);
}

std::optional<double> noise_sigma(std::optional<double> stated, double squared_sum, int dof,
                                  double rounding) {
  if (stated) return *stated > 0 && std::isfinite(*stated) ? stated : std::nullopt;
  if (dof < 1 || !std::isfinite(squared_sum)) return std::nullopt;
  return std::max(std::sqrt(squared_sum / dof), rounding);
}

Eigen::Matrix<double, 6, 1> pose_error(const geometry::Pose& pose,
                                       const geometry::Pose& reference) {
  Eigen::Matrix<double, 6, 1> error;
  error << rotation_log(pose.rotation * reference.rotation.conjugate()),
      pose.translation_m - reference.translation_m;
  return error;
}

Eigen::Vector3d rotation_log(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * rotation.vec();
  const double sine = v.norm();
  if (sine < 1e-12) return 2.0 * v;
  return 2.0 * std::atan2(sine, sign * rotation.w()) / sine * v;
}

Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& w_rad) {
  const double angle = w_rad.norm();
  if (angle < 1e-12) return Eigen::Quaterniond(1, w_rad.x() / 2, w_rad.y() / 2, w_rad.z() / 2);
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, w_rad / angle));
}

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace mixrig::estimation
