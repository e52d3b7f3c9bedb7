// SPDX-License-Identifier: Apache-2.0
// A point from its distances to known points (Cortes Reina 2015, section 2.5).
#pragma once

#include <optional>
#include <span>

#include "hal/base/result.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::estimation {

struct MultilaterationOptions {
  /// Standard deviation of a range, m. If it is given, outliers are searched for too; if not, it
  /// is estimated from the residuals.
  std::optional<double> sigma_m;
  /// Approximate position of the point: selects one of the two sides of (nearly) coplanar centres.
  std::optional<Eigen::Vector3d> near_m;
};

/// Geometric least squares: minimises the sum of (|x - centre_i| - range_i)^2, from linear and
/// mirrored starts. Covariance 3x3 of x in m^2; residuals |x - centre| - range in m.
/// Degenerate: fewer than 4 ranges (3 with `near_m` and `sigma_m`), collinear centres, coplanar
/// centres without `near_m` (two mirrored solutions), a point in the plane of its centres.
Estimate<Eigen::Vector3d> multilaterate(std::span<const Eigen::Vector3d> centres_m,
                                        std::span<const double> ranges_m,
                                        const MultilaterationOptions& options = {});

/// The linear solution of Cortes Reina 2015, eq. 86 to 89: the equation of sphere `reference` is
/// subtracted from all others. Reproduces published figures; it weights the reference's error n
/// times. Errors: kData where the system is singular.
Result<Eigen::Vector3d> multilaterate_linear(std::span<const Eigen::Vector3d> centres_m,
                                             std::span<const double> ranges_m, int reference);

}  // namespace mixrig::estimation
