// SPDX-License-Identifier: Apache-2.0
// Counter-based random numbers.
#include "studio/sensors/noise.h"

namespace mixrig::studio {
namespace {

/// Inverse of the normal distribution function by bisection; called 4096 times at start.
double normal_quantile(double probability) {
  double low = -8, high = 8;
  for (int i = 0; i < 48; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle / std::sqrt(2.0)) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

float ease_noise(float t) { return t * t * (3.0F - 2.0F * t); }

/// Random values of the four corners of a lattice cell: (x, y), (x + 1, y), and the row y + 1.
/// Each is uniform(hash_key(seed, x, y)); what the corners share is hashed once.
std::array<float, 4> lattice_cell(int x, int y, std::uint64_t seed) {
  const std::uint64_t start = mix_bits(seed);
  const std::uint64_t left = mix_bits(start ^ static_cast<std::uint32_t>(x));
  const std::uint64_t right = mix_bits(start ^ static_cast<std::uint32_t>(x + 1));
  const std::uint64_t top = static_cast<std::uint32_t>(y),
                      bottom = static_cast<std::uint32_t>(y + 1);
  const std::array<std::uint64_t, 4> keys{left ^ top, right ^ top, left ^ bottom, right ^ bottom};
  std::array<float, 4> values;
  for (std::size_t i = 0; i < 4; ++i) values[i] = uniform(mix_bits(keys[i]));
  return values;
}

}  // namespace

NormalTable::NormalTable() {
  for (std::size_t i = 0; i < quantiles_.size(); ++i)
    quantiles_[i] = static_cast<float>(normal_quantile((static_cast<double>(i) + 0.5) / 4096.0));
}

float value_noise(const Eigen::Vector2f& p, std::uint64_t seed) {
  const float fx = std::floor(p.x()), fy = std::floor(p.y());
  const int x = static_cast<int>(fx), y = static_cast<int>(fy);
  const float u = ease_noise(p.x() - fx), v = ease_noise(p.y() - fy);
  const std::array<float, 4> at = lattice_cell(x, y, seed);
  const float top = std::lerp(at[0], at[1], u), bottom = std::lerp(at[2], at[3], u);
  return std::lerp(top, bottom, v);
}

float fractal_noise(Eigen::Vector2f p, int octaves, std::uint64_t seed) {
  float sum = 0, weight = 0.5F, total = 0;
  for (int i = 0; i < octaves; ++i, p *= 2.0F, weight *= 0.5F) {
    sum += weight * value_noise(p, seed + static_cast<std::uint64_t>(i));
    total += weight;
  }
  return sum / total;
}

float wander(float t, std::uint64_t seed) { return 2.0F * value_noise({t, 0.5F}, seed) - 1.0F; }

}  // namespace mixrig::studio
