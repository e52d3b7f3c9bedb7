// SPDX-License-Identifier: Apache-2.0
// The cheapest assignment of rows to columns.
#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

namespace mixrig::plan {

/// Cost of a pair that must not be.
inline constexpr double kForbidden = std::numeric_limits<double>::infinity();

/// For each row its column, -1 for none. As many pairs as are allowed, and of these the cheapest in
/// sum (shortest augmenting paths, Jonker and Volgenant 1987). Costs are at least 0.
std::vector<int> assign(const Eigen::MatrixXd& cost);

}  // namespace mixrig::plan
