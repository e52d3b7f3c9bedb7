// SPDX-License-Identifier: Apache-2.0
#include "host/bench/color_upsample.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixrig::bench {
namespace {

constexpr float kColorSigma = 14;  // of 255
constexpr float kReach = 1.1F;     // standard deviation of the distance, samples

/// Mean over 3x3 pixels.
Rgbf mean_color(ImageView<const Rgb8> color, int x, int y) {
  Rgbf sum;
  for (int v = y - 1; v <= y + 1; ++v)
    for (int u = x - 1; u <= x + 1; ++u) {
      const Rgb8 c = color.row(
          std::clamp(v, 0, color.size.height - 1))[std::clamp(u, 0, color.size.width - 1)];
      sum.r += c.r, sum.g += c.g, sum.b += c.b;
    }
  return {sum.r / 9, sum.g / 9, sum.b / 9};
}

float distance2(const Rgbf& a, Rgb8 b) {
  const float r = a.r - static_cast<float>(b.r), g = a.g - static_cast<float>(b.g),
              l = a.b - static_cast<float>(b.b);
  return r * r + g * g + l * l;
}

/// A pixel between samples (i, j) and (i + 1, j + 1), at (u, v) of them, 0..1.
struct Place {
  int i = 0, j = 0;
  float u = 0, v = 0;
};

class Chooser {
 public:
  Chooser(const Image<float>& low, ImageView<const Rgb8> color, int factor) : low_(low) {
    colors_.reset(low.size());
    for (int y = 0; y < low.height(); ++y)
      for (int x = 0; x < low.width(); ++x)
        colors_.row(y)[x] = mean_color(color, factor * x + factor / 2, factor * y + factor / 2);
  }

  float sample(int i, int j) const {
    return low_.row(std::clamp(j, 0, low_.height() - 1))[std::clamp(i, 0, low_.width() - 1)];
  }

  /// Of the two surfaces around; 0 where no sample is known.
  float choose(const Place& at, float middle, Rgb8 color) const {
    std::array<float, 2> weights{}, sums{};
    for (int j = at.j - 1; j <= at.j + 2; ++j)
      for (int i = at.i - 1; i <= at.i + 2; ++i) {
        const float w = sample(i, j);
        if (!(w > 0)) continue;
        const int x = std::clamp(i, 0, low_.width() - 1), y = std::clamp(j, 0, low_.height() - 1);
        const float dx = static_cast<float>(i - at.i) - at.u;
        const float dy = static_cast<float>(j - at.j) - at.v;
        const float weight =
            std::exp(-(dx * dx + dy * dy) / (2 * kReach * kReach) -
                     distance2(colors_.row(y)[x], color) / (2 * kColorSigma * kColorSigma)) +
            1e-12F;
        const std::size_t side = w > middle ? 1 : 0;
        weights[side] += weight, sums[side] += weight * w;
      }
    const std::size_t side = weights[1] > weights[0] ? 1 : 0;
    return weights[side] > 0 ? sums[side] / weights[side] : 0;
  }

 private:
  const Image<float>& low_;
  Image<Rgbf> colors_;
};

}  // namespace

void upsample_by_color(const Image<float>& low, ImageView<const Rgb8> color, int factor,
                       float most_step, Image<float>& out) {
  out.reset(color.size);
  const Chooser chooser(low, color, factor);
  const float scale = 1 / static_cast<float>(factor);
  const auto half = static_cast<float>(factor / 2);
  for (int y = 0; y < color.size.height; ++y)
    for (int x = 0; x < color.size.width; ++x) {
      const float u = std::max(0.0F, (static_cast<float>(x) - half) * scale);
      const float v = std::max(0.0F, (static_cast<float>(y) - half) * scale);
      Place at{static_cast<int>(u), static_cast<int>(v)};
      at.u = u - static_cast<float>(at.i), at.v = v - static_cast<float>(at.j);
      const float a = chooser.sample(at.i, at.j), b = chooser.sample(at.i + 1, at.j);
      const float c = chooser.sample(at.i, at.j + 1), d = chooser.sample(at.i + 1, at.j + 1);
      const auto [least, most] = std::minmax({a, b, c, d});
      out.row(y)[x] =
          least > 0 && most - least <= most_step * most
              ? (1 - at.v) * ((1 - at.u) * a + at.u * b) + at.v * ((1 - at.u) * c + at.u * d)
              : chooser.choose(at, 0.5F * (least + most), color.row(y)[x]);
    }
}

}  // namespace mixrig::bench
