// SPDX-License-Identifier: Apache-2.0
// Noise of a depth camera.
#pragma once

namespace mixrig::geometry {

/// Standard deviation of a depth value at z: floor + linear z + quadratic z^2, metres.
struct DepthNoise {
  double floor_m = 0.005, linear = 0.002, quadratic_per_m = 0.001;
  double sigma_m(double z_m) const { return floor_m + z_m * (linear + z_m * quadratic_per_m); }
};

}  // namespace mixrig::geometry
