// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/bounced_light.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace mixrig::depth {
namespace {

constexpr int kEntries = 64;
constexpr float kLeastCoarse_m = -0.1F, kMostCoarse_m = 0.7F;
constexpr float kLeastFineLight = 0.2F, kMostFineLight = 1.1F;
// Standard deviations of the two measured numbers as means over a window, including the error of
// the camera's constants.
constexpr double kCoarseSigma_m = 0.03, kLightSigma = 0.02;
constexpr double kSharePenalty = 0.02;  ///< prefers the weaker of two tails that fit equally well
constexpr double kMostShare = 4, kLeastWay_m = 0.05, kMostWay_m = 6, kStep = 1.2;

struct Tail {
  double share = 0, coarse_m = 0, fine_light = 1;
  BouncedLight::Effect effect;
};

/// Returns the tail of a given share; `way_m` is half of its mean extra path.
Tail tail_of(double share, double way_m, const std::array<double, 3>& range_m) {
  std::array<double, 3> error_m{}, light{};
  for (std::size_t f = 0; f < 3; ++f) {
    const double turn_m = range_m[f] / (2 * std::numbers::pi);
    // The phase grows with the path, so later light turns the phasor forward.
    const std::complex<double> phasor = 1.0 + share / std::complex<double>(1, -way_m / turn_m);
    error_m[f] = turn_m * std::arg(phasor);
    light[f] = std::abs(phasor);
  }
  return {share,
          error_m[1] - error_m[2],
          light[2] / light[1],
          {static_cast<float>(error_m[2]), static_cast<float>(error_m[0] - error_m[2]),
           static_cast<float>(light[0] / light[1])}};
}

float place(float value, float least, float most) {
  return std::clamp((value - least) / (most - least), 0.0F, 1.0F) * (kEntries - 1);
}

}  // namespace

BouncedLight::BouncedLight(const std::array<double, 3>& range_m) {
  std::vector<Tail> tails{tail_of(0, kLeastWay_m, range_m)};
  for (double share = 0.01; share < kMostShare; share *= kStep)
    for (double way_m = kLeastWay_m; way_m < kMostWay_m; way_m *= kStep)
      tails.push_back(tail_of(share, way_m, range_m));
  for (int c = 0; c < kEntries; ++c)
    for (int l = 0; l < kEntries; ++l) {
      constexpr double kSteps = kEntries - 1;
      const double coarse_m = kLeastCoarse_m + c / kSteps * (kMostCoarse_m - kLeastCoarse_m);
      const double light = kLeastFineLight + l / kSteps * (kMostFineLight - kLeastFineLight);
      const Tail* best = nullptr;
      double least = 0;
      for (const Tail& tail : tails) {
        const double off = (coarse_m - tail.coarse_m) / kCoarseSigma_m;
        const double dim = (light - tail.fine_light) / kLightSigma;
        const double cost = off * off + dim * dim + kSharePenalty * tail.share * tail.share;
        if (best == nullptr || cost < least) best = &tail, least = cost;
      }
      table_.push_back(best->effect);
    }
}

const BouncedLight::Effect& BouncedLight::entry(int coarse, int light) const {
  return table_[static_cast<std::size_t>(coarse * kEntries + light)];
}

BouncedLight::Effect BouncedLight::at(float coarse_m, float fine_light) const {
  const float x = place(coarse_m, kLeastCoarse_m, kMostCoarse_m);
  const float y = place(fine_light, kLeastFineLight, kMostFineLight);
  const int i = std::min(static_cast<int>(x), kEntries - 2);
  const int j = std::min(static_cast<int>(y), kEntries - 2);
  const float u = x - static_cast<float>(i), v = y - static_cast<float>(j);
  const auto mix = [&](float Effect::*part) {
    return (1 - u) * ((1 - v) * entry(i, j).*part + v * entry(i, j + 1).*part) +
           u * ((1 - v) * entry(i + 1, j).*part + v * entry(i + 1, j + 1).*part);
  };
  return {mix(&Effect::fine_m), mix(&Effect::spread_m), mix(&Effect::first_light)};
}

bool BouncedLight::covers(float coarse_m, float fine_light) {
  return coarse_m < kMostCoarse_m && fine_light > kLeastFineLight;
}

}  // namespace mixrig::depth
