// SPDX-License-Identifier: Apache-2.0
// The cheapest assignment of rows to columns.
#pragma once

#include <limits>
#include <vector>

#include <Eigen/Core>

namespace mixrig::plan {

/// Cost of a forbidden pair.
inline constexpr double kForbidden = std::numeric_limits<double>::infinity();

/// Column of each row, -1 for none. Makes as many pairs as are allowed, at the least total cost
/// (shortest augmenting paths, Jonker and Volgenant 1987). Costs are at least 0.
std::vector<int> assign(const Eigen::MatrixXd& cost);

}  // namespace mixrig::plan
