// SPDX-License-Identifier: Apache-2.0
// The natural cubic spline of a ToF camera's depth error.
#include <algorithm>
#include <cmath>

#include "host/capture/calibration_file/depth_sigma.h"

namespace mixrig::calibration_file {
namespace {

/// Second derivatives of the natural cubic spline at its knots: a tridiagonal system, solved by
/// elimination.
std::vector<double> curvatures(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> m(n, 0.0), factor(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double left = x[i] - x[i - 1], right = x[i + 1] - x[i];
    const double wanted = 6 * ((y[i + 1] - y[i]) / right - (y[i] - y[i - 1]) / left);
    const double pivot = 2 * (left + right) - left * factor[i - 1];
    factor[i] = right / pivot;
    m[i] = (wanted - left * m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) m[i] -= factor[i] * m[i + 1];
  return m;
}

double spline(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (x.empty()) return 0;
  if (x.size() == 1) return y.front();
  // Nothing was measured beyond the ends. The error of a ToF camera oscillates about its mean, so
  // its value at the end is closer to it than an extrapolated line.
  if (at <= x.front()) return y.front();
  if (at >= x.back()) return y.back();
  const auto m = curvatures(x, y);
  const std::size_t i =
      static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin()) - 1;
  const double h = x[i + 1] - x[i], b = (at - x[i]) / h, a = 1 - b;
  return a * y[i] + b * y[i + 1] +
         ((a * a * a - a) * m[i] + (b * b * b - b) * m[i + 1]) * h * h / 6;
}

}  // namespace

double DepthError::at(double distance_m, double amplitude, const Eigen::Vector2d& px,
                      Size size) const {
  const double u = 2 * px.x() / std::max(size.width - 1, 1) - 1;
  const double v = 2 * px.y() / std::max(size.height - 1, 1) - 1;
  return spline(knots_m, error_m, distance_m) + (amplitude > 0 ? amplitude_m / amplitude : 0) +
         place_m[0] * u + place_m[1] * v + place_m[2] * u * u + place_m[3] * u * v +
         place_m[4] * v * v;
}

double depth_sigma_m(const DepthError& error, double distance_m) {
  const auto knots = static_cast<Eigen::Index>(error.knots_m.size());
  if (error.covariance.rows() < knots || error.covariance.cols() < knots) return 0;
  // The spline is linear in its values.
  Eigen::VectorXd by_value(knots);
  std::vector<double> one(error.knots_m.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    one.assign(one.size(), 0), one[i] = 1;
    by_value[static_cast<Eigen::Index>(i)] = spline(error.knots_m, one, distance_m);
  }
  const double variance = by_value.dot(error.covariance.topLeftCorner(knots, knots) * by_value);
  return std::sqrt(std::max(0.0, variance));
}

}  // namespace mixrig::calibration_file
