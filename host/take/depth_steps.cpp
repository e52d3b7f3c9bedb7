// SPDX-License-Identifier: Apache-2.0
#include "host/take/depth_steps.h"

#include <algorithm>
#include <cmath>

namespace mixrig::take {

void to_steps(const Image<float>& image, double unit, int unknown, Image<std::uint16_t>& steps) {
  if (steps.size() != image.size()) steps.reset(image.size());
  const auto step_of = [=](float value) {
    const double step = std::round(value / unit);
    return static_cast<std::uint16_t>(step >= 0.5 && step <= 65535.0 ? step : unknown);
  };
  for (int y = 0; y < image.height(); ++y)
    std::transform(image.row(y), image.row(y) + image.width(), steps.row(y), step_of);
}

}  // namespace mixrig::take
