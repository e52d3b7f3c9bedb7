// SPDX-License-Identifier: Apache-2.0
// The light on ink and paper of a rendered board.
#pragma once

#include <vector>

#include "hal/base/image.h"
#include "host/calibrate/rig/board_render.h"

namespace mixrig::calibration {

/// Coefficients of the light: kLight for paper, then kLight for ink.
using Light = Eigen::Matrix<double, 2 * kLight, 1>;

/// Normal equations of the light. Sums of the terms' products are shared by ink and paper.
class LightSum {
 public:
  void add(const LightRow& terms, double ink, double weight, double value);
  Eigen::Matrix<double, 2 * kLight, 2 * kLight> products() const;
  Light values() const;  ///< sum of weight * value * terms
  double squares() const { return squares_; }

 private:
  using Block = Eigen::Matrix<double, kLight, kLight>;
  Block paper_ = Block::Zero(), both_ = Block::Zero(), ink_ = Block::Zero();
  LightRow paper_value_ = LightRow::Zero(), ink_value_ = LightRow::Zero();
  double squares_ = 0;
};

struct LightFit {
  Light light = Light::Zero();
  double sigma = 0;  ///< root mean square of the residuals
  double share = 0;  ///< share of the variance that the light explains
};
/// Fits the light to rendered samples in two passes; the second one weights outliers down.
LightFit solve_light(const std::vector<Sample>& samples, const Image<float>& picture);

}  // namespace mixrig::calibration
