// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "hal/base/image.h"

namespace mixrig::test {

/// Peak signal-to-noise ratio of two pictures of the same size; 100 if they are equal.
inline double psnr_db(ImageView<const Rgb8> a, ImageView<const Rgb8> b) {
  double sum = 0;
  for (int y = 0; y < a.size.height; ++y)
    for (int x = 0; x < a.size.width; ++x) {
      const Rgb8 p = a.at(x, y), q = b.at(x, y);
      for (const int d : {p.r - q.r, p.g - q.g, p.b - q.b}) sum += d * d;
    }
  const double mean = sum / (3.0 * static_cast<double>(a.size.area()));
  return mean > 0 ? 10 * std::log10(255.0 * 255.0 / mean) : 100;
}

}  // namespace mixrig::test
