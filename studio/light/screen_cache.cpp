// SPDX-License-Identifier: Apache-2.0
// Directions for the values of a cache.
#include "studio/light/screen_cache.h"

#include <cmath>

#include <Eigen/Geometry>

namespace mixrig::studio {

Vec3 hemisphere_direction(const Vec3& normal, int i, int n) {
  constexpr float kGolden_rad = 2.39996323F;
  const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(n);
  const float r = std::sqrt(share), up = std::sqrt(1 - share);
  const float angle = kGolden_rad * static_cast<float>(i);
  const Vec3 other = std::abs(normal.z()) < 0.9F ? Vec3::UnitZ() : Vec3::UnitX();
  const Vec3 x = other.cross(normal).normalized(), y = normal.cross(x);
  return r * std::cos(angle) * x + r * std::sin(angle) * y + up * normal;
}

}  // namespace mixrig::studio
