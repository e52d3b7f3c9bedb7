// SPDX-License-Identifier: Apache-2.0
// Least squares in 50-digit arithmetic with numeric derivatives: shares no code with what it
// judges.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "host/math/geometry/pose.h"

namespace mixrig::estimation_bench {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                           boost::multiprecision::et_off>;
using Reals = std::vector<Real>;
/// Whitened residuals of parameters, which are 0 at the truth.
using Residuals = std::function<Reals(const Reals&)>;

/// A rotation matrix and translation.
struct Motion {
  Real r[3][3];
  Real t[3];
};
/// exp(w) * pose.rotation and pose.translation + dt, from parameters x[at .. at+5].
Motion moved(const geometry::Pose& pose, const Reals& x, std::size_t at = 0);
/// Like moved(), but dt moves the image of `centre`: far from the origin, a turn about the origin
/// and a shift can hardly be told apart.
Motion moved_about(const geometry::Pose& pose, const Eigen::Vector3d& centre, const Reals& x);
/// rotation * p + translation.
Reals mapped(const Motion& motion, const Reals& p);
/// rotation^T * (p - translation).
Reals mapped_back(const Motion& motion, const Reals& p);
/// first * second: second is applied first.
Motion product(const Motion& first, const Motion& second);
/// Appends the whitened error of inverse(base_from_eye) * base_from_target against the measured
/// eye_from_target: rotation vector, then translation.
void add_pose_residuals(const Motion& base_from_eye, const Motion& base_from_target,
                        const Motion& eye_from_target, const Real& sigma_rad, const Real& sigma_m,
                        Reals& residuals);
Reals reals(const Eigen::Vector3d& v);
Real length(const Reals& v);

/// Inverse of the Fisher information at the truth: the Cramer-Rao bound. In 50 digits, so that
/// nothing is lost far from the origin.
Eigen::MatrixXd cramer_rao(const Residuals& residuals, int parameters);
/// The minimum next to the truth, by Gauss-Newton.
Eigen::VectorXd minimum(const Residuals& residuals, int parameters);

}  // namespace mixrig::estimation_bench
