// SPDX-License-Identifier: Apache-2.0
// The inverse of a Hessian that may lack directions. Private to this room.
#pragma once

#include <Eigen/Core>

namespace mixrig::sync {

/// Inverse over the directions that the data tell, 0 over the others. `lever`: where three
/// parameters of one unit begin.
Eigen::MatrixXd inverse_of_told(const Eigen::MatrixXd& hessian, int lever);

}  // namespace mixrig::sync
