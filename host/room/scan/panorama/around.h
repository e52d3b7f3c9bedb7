// SPDX-License-Identifier: Apache-2.0
// Bilinear neighbourhood: the four pixels of a panorama around a position.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::model {

/// Pixels around a position, and its place between them. Columns go around, rows end at the poles.
struct Around {
  Around(Size size, const Eigen::Vector2d& at) {
    const double left = std::floor(at.x()), top = std::floor(at.y());
    fx = static_cast<float>(at.x() - left), fy = static_cast<float>(at.y() - top);
    const int x = static_cast<int>(left);
    x0 = (x + size.width) % size.width, x1 = (x + 1 + size.width) % size.width;
    y0 = std::clamp(static_cast<int>(top), 0, size.height - 1);
    y1 = std::clamp(static_cast<int>(top) + 1, 0, size.height - 1);
  }
  /// Values of the image at top left, top right, bottom left, bottom right.
  template <typename T>
  std::array<T, 4> of(const Image<T>& image) const {
    return {image.row(y0)[x0], image.row(y0)[x1], image.row(y1)[x0], image.row(y1)[x1]};
  }
  std::size_t nearest() const { return (fy > 0.5F ? 2U : 0U) + (fx > 0.5F ? 1U : 0U); }
  float mix(float a, float b, float c, float d) const {
    return (1 - fy) * (a + fx * (b - a)) + fy * (c + fx * (d - c));
  }
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  float fx = 0, fy = 0;
};

}  // namespace mixrig::model
