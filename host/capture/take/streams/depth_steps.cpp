// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/depth_steps.h"

#include <algorithm>
#include <cmath>

namespace mixrig::take {

void to_steps(const Image<float>& image, const Steps& steps, Image<std::uint16_t>& out) {
  if (out.size() != image.size()) out.reset(image.size());
  const auto step_of = [=](float value) {
    const double step = std::round((value - steps.offset) / steps.unit);
    return static_cast<std::uint16_t>(value > 0 && step >= 0 && step <= 65535 ? step
                                                                              : steps.unknown[0]);
  };
  for (int y = 0; y < image.height(); ++y)
    std::transform(image.row(y), image.row(y) + image.width(), out.row(y), step_of);
}

void from_steps(const Image<std::uint16_t>& image, const Steps& steps, Image<float>& out) {
  if (out.size() != image.size()) out.reset(image.size());
  const auto value_of = [=](std::uint16_t step) {
    const double value = steps.offset + step * steps.unit;
    const auto& none = steps.unknown;
    const bool unknown =
        (step == none[0]) | (step == none[1]) | (step == none[2]) | (step == none[3]);
    return unknown || value < 0 ? 0.0F : static_cast<float>(value);
  };
  for (int y = 0; y < image.height(); ++y)
    std::transform(image.row(y), image.row(y) + image.width(), out.row(y), value_of);
}

}  // namespace mixrig::take
