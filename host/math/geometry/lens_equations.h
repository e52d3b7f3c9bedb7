// SPDX-License-Identifier: Apache-2.0
// Equations of the lens models, shared by camera classes and projections. Private to this module.
#pragma once

#include <cmath>

namespace mixrig::geometry {

/// Factor by which a Brown-Conrady or rational lens scales a point at x2 + y2 = r2.
struct Radial {
  double gain;         ///< numerator / denominator
  double derivative;   ///< d gain / d r2
  double denominator;  ///< 1 + k4 r2 + k5 r4 + k6 r6
};

/// `k`: k1 k2 p1 p2 k3 k4 k5 k6.
inline Radial radial(const double* k, double r2) {
  const double numerator = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double denominator = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double numerator_d = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);
  const double denominator_d = k[5] + r2 * (2 * k[6] + r2 * 3 * k[7]);
  return {numerator / denominator,
          (numerator_d * denominator - numerator * denominator_d) / (denominator * denominator),
          denominator};
}

/// Returns theta_d of the Kannala-Brandt fisheye; `k`: k1 k2 k3 k4.
inline double bend(const double* k, double theta) {
  const double t2 = theta * theta;
  return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

/// Returns the derivative d theta_d / d theta.
inline double bend_slope(const double* k, double theta) {
  const double t2 = theta * theta;
  return 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
}

}  // namespace mixrig::geometry
