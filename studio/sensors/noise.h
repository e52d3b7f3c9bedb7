// SPDX-License-Identifier: Apache-2.0
// Counter-based random numbers: a value depends on its key only, not on the order of calls.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

namespace mixrig::studio {

/// Mixes the bits of a counter (splitmix64's finaliser, Steele et al. 2014).
inline std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}
inline std::uint64_t hash_key(std::uint64_t a, std::uint64_t b, std::uint64_t c = 0) {
  return mix_bits(mix_bits(mix_bits(a) ^ b) ^ c);
}
/// Uniform in [0, 1).
inline float uniform(std::uint64_t key) {
  return static_cast<float>(mix_bits(key) >> 40) * 0x1p-24F;
}

/// Standard normal values from a table of 4096 quantiles: 12 bits of a hash give one value.
class NormalTable {
 public:
  NormalTable();
  float operator()(std::uint64_t bits12) const { return quantiles_[bits12 & 4095U]; }

 private:
  std::array<float, 4096> quantiles_;
};

/// Value noise in [0, 1]: random values on the integer lattice, interpolated smoothly.
float value_noise(const Eigen::Vector2f& p, std::uint64_t seed);
/// Sum of `octaves` of value_noise, each with half the amplitude and twice the frequency; in [0,
/// 1].
float fractal_noise(Eigen::Vector2f p, int octaves, std::uint64_t seed);
/// Smooth noise of one variable in [-1, 1].
float wander(float t, std::uint64_t seed);

}  // namespace mixrig::studio
