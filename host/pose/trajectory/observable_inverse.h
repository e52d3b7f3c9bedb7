// SPDX-License-Identifier: Apache-2.0
// The pseudo-inverse of a Hessian that may be singular. Private to this module.
#pragma once

#include <Eigen/Core>

namespace mixrig::trajectory {

/// Returns the inverse over the observable directions, 0 over the others. `lever`: index of the
/// first of three parameters that share a unit and are scaled alike.
Eigen::MatrixXd observable_inverse(const Eigen::MatrixXd& hessian, int lever);

}  // namespace mixrig::trajectory
