// SPDX-License-Identifier: Apache-2.0
// The light on ink and paper of a rendered board.
#include "host/calibrate/rig/pixel_light.h"

#include <algorithm>
#include <cmath>

#include "host/math/estimation/decompositions.h"

namespace mixrig::calibration {
namespace {

constexpr double kLightHuber = 3;  // sigmas

double miss_of(const Sample& s, const Light& light, const Image<float>& picture) {
  return picture.at(s.x, s.y) - (1 - s.ink) * s.light.dot(light.head<kLight>()) -
         s.ink * s.light.dot(light.tail<kLight>());
}

}  // namespace

void LightSum::add(const LightRow& terms, double ink, double weight, double value) {
  const double paper = 1 - ink;
  const LightRow weighted = weight * terms;
  const Block product = weighted * terms.transpose();
  if (paper != 0) paper_ += paper * paper * product, paper_value_ += paper * value * weighted;
  if (ink != 0) ink_ += ink * ink * product, ink_value_ += ink * value * weighted;
  if (ink != 0 && paper != 0) both_ += ink * paper * product;
  squares_ += weight * value * value;
}

Eigen::Matrix<double, 2 * kLight, 2 * kLight> LightSum::products() const {
  Eigen::Matrix<double, 2 * kLight, 2 * kLight> all;
  all << paper_, both_, both_, ink_;
  return all;
}

Light LightSum::values() const {
  Light all;
  all << paper_value_, ink_value_;
  return all;
}

LightFit solve_light(const std::vector<Sample>& samples, const Image<float>& picture) {
  LightFit fit;
  double sum = 0, squares = 0;
  for (const Sample& s : samples) {
    const double value = picture.at(s.x, s.y);
    sum += value, squares += value * value;
  }
  const auto n = static_cast<double>(samples.size());
  for (int round = 0; round < 2; ++round) {
    LightSum sums;
    for (const Sample& s : samples) {
      const double miss = round > 0 ? std::abs(miss_of(s, fit.light, picture)) : 0;
      const double weight = miss > kLightHuber * fit.sigma ? kLightHuber * fit.sigma / miss : 1;
      sums.add(s.light, s.ink, weight, picture.at(s.x, s.y));
    }
    auto h = sums.products();
    h.diagonal().array() += 1e-9 * h.trace() / (2 * kLight);
    fit.light = estimation::SymmetricSolver(h).solve(sums.values());
    double misses = 0;
    for (const Sample& s : samples) misses += std::pow(miss_of(s, fit.light, picture), 2);
    fit.sigma = std::sqrt(misses / n);
    fit.share = 1 - misses / std::max(squares - sum * sum / n, 1e-30);
  }
  return fit;
}

}  // namespace mixrig::calibration
