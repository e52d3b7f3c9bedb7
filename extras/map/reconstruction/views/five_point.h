// SPDX-License-Identifier: Apache-2.0
// Estimates the relative pose of two calibrated views from five pairs of rays. Private to this
// module.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace mixrig::reconstruction {

/// Essential matrices E with b^T E a = 0 for five pairs of unit rays, b = R a-side: the polynomial
/// system of Nister 2004 (det E = 0 and 2 E E^T E = trace(E E^T) E), solved by the eigenvectors of
/// the action matrix of one unknown (Stewenius, Engels and Nister 2006). Up to ten; none for rays
/// that do not determine any.
std::vector<Eigen::Matrix3d> essential_of_five(const std::array<Eigen::Vector3d, 5>& a,
                                               const std::array<Eigen::Vector3d, 5>& b);

}  // namespace mixrig::reconstruction
