// SPDX-License-Identifier: Apache-2.0
// Seeded random points, rotations and noise for tests of estimators.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "host/math/geometry/pose.h"

namespace mixrig::estimation_bench {

class RandomGeometry {
 public:
  explicit RandomGeometry(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  /// Normal, by Box and Muller: the same numbers with every standard library.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform(0, 1)));
    return radius * std::cos(uniform(0, 2 * M_PI));
  }
  Eigen::Vector3d normal3(double sigma = 1) {
    const double x = normal(), y = normal(), z = normal();
    return sigma * Eigen::Vector3d(x, y, z);
  }
  Eigen::Vector3d in_box(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }
  Eigen::Quaterniond rotation() {
    const double w = normal(), x = normal(), y = normal(), z = normal();
    return Eigen::Quaterniond(w, x, y, z).normalized();
  }
  geometry::Pose pose(double half_m) {
    const auto q = rotation();
    return {q, in_box(half_m)};
  }
  std::vector<Eigen::Vector3d> cloud(int count, double half) {
    std::vector<Eigen::Vector3d> points(count);
    for (auto& p : points) p = in_box(half);
    return points;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mixrig::estimation_bench
