// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/i420.h"

#include <algorithm>

namespace mixrig::output {
namespace {

struct I420Layout {
  std::size_t luma_stride, chroma_stride, blue_at, red_at, bytes;
};

I420Layout i420_layout(Size size) {
  const auto up = [](int value, int to) {
    return static_cast<std::size_t>((value + to - 1) / to * to);
  };
  I420Layout at{};
  at.luma_stride = up(size.width, 4);
  at.chroma_stride = up((size.width + 1) / 2, 4);
  at.blue_at = at.luma_stride * up(size.height, 2);
  const std::size_t chroma = at.chroma_stride * (up(size.height, 2) / 2);
  at.red_at = at.blue_at + chroma;
  at.bytes = at.red_at + chroma;
  return at;
}

// Weights in 1 / 65536 of a level, of red, green and blue in 0..255.
constexpr double kRange = 219.0 / 255, kChroma = 224.0 / 255;
constexpr int kShift = 16;
constexpr int weight(double value) {
  return static_cast<int>(value * (1 << kShift) + (value < 0 ? -0.5 : 0.5));
}
constexpr double kR = 0.2126, kG = 0.7152, kB = 0.0722;
constexpr int kYr = weight(kRange * kR), kYg = weight(kRange * kG), kYb = weight(kRange * kB);
constexpr int kBr = weight(-kChroma * kR / 1.8556), kBg = weight(-kChroma * kG / 1.8556),
              kBb = weight(kChroma * 0.5);
constexpr int kRr = weight(kChroma * 0.5), kRg = weight(-kChroma * kG / 1.5748),
              kRb = weight(-kChroma * kB / 1.5748);

struct RgbSum {
  int r = 0, g = 0, b = 0;
};

std::uint8_t rounded(int value, int offset, int shift) {
  return static_cast<std::uint8_t>(
      std::clamp((value + (offset << shift) + (1 << (shift - 1))) >> shift, 0, 255));
}

}  // namespace

std::size_t i420_bytes(Size size) { return i420_layout(size).bytes; }

void i420_from(std::span<const std::uint8_t> from, std::size_t stride, std::size_t pixel_bytes,
               Size size, std::span<std::uint8_t> to) {
  const I420Layout at = i420_layout(size);
  const auto pixel = [&](int x, int y) -> RgbSum {
    const std::uint8_t* p = from.data() + static_cast<std::size_t>(y) * stride +
                            static_cast<std::size_t>(x) * pixel_bytes;
    return pixel_bytes == 1 ? RgbSum{p[0], p[0], p[0]} : RgbSum{p[2], p[1], p[0]};
  };
  for (int y = 0; y < size.height; ++y) {
    std::uint8_t* luma = to.data() + static_cast<std::size_t>(y) * at.luma_stride;
    for (int x = 0; x < size.width; ++x) {
      const RgbSum c = pixel(x, y);
      luma[x] = rounded(kYr * c.r + kYg * c.g + kYb * c.b, 16, kShift);
    }
  }
  for (int y = 0; y < size.height; y += 2) {
    const std::size_t row = static_cast<std::size_t>(y / 2) * at.chroma_stride;
    std::uint8_t *blue = to.data() + at.blue_at + row, *red = to.data() + at.red_at + row;
    for (int x = 0; x < size.width; x += 2) {
      RgbSum sum;
      for (int i = 0; i < 4; ++i) {
        const RgbSum c =
            pixel(std::min(x + i % 2, size.width - 1), std::min(y + i / 2, size.height - 1));
        sum = {sum.r + c.r, sum.g + c.g, sum.b + c.b};
      }
      // Four pixels: two more bits.
      blue[x / 2] = rounded(kBr * sum.r + kBg * sum.g + kBb * sum.b, 128, kShift + 2);
      red[x / 2] = rounded(kRr * sum.r + kRg * sum.g + kRb * sum.b, 128, kShift + 2);
    }
  }
}

}  // namespace mixrig::output
