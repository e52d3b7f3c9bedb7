// SPDX-License-Identifier: Apache-2.0
// The studio's own sRGB curve and texture lookup.
#include "studio/srgb.h"

#include <cmath>
#include <vector>

namespace mixrig::studio {
namespace {

constexpr int kSteps = 1 << 14;

std::array<float, 256> make_decode() {
  std::array<float, 256> table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double c = static_cast<double>(i) / 255.0;
    table[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return table;
}

std::vector<std::uint8_t> make_encode() {
  std::vector<std::uint8_t> table(kSteps + 1);
  for (int i = 0; i <= kSteps; ++i) {
    const double c = static_cast<double>(i) / kSteps;
    const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    table[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255 * s));
  }
  return table;
}

}  // namespace

float linear_from_srgb(std::uint8_t value) {
  static const std::array<float, 256> table = make_decode();
  return table[value];
}

std::uint8_t srgb_from_linear(float value) {
  static const std::vector<std::uint8_t> table = make_encode();
  const float clamped = value > 0 ? (value < 1 ? value : 1.0F) : 0.0F;
  return table[static_cast<std::size_t>(clamped * kSteps + 0.5F)];
}

Vec3 sample_texture(ImageView<const Rgb8> texture, const Vec2& uv) {
  const auto wrap = [](int i, int n) { return (i % n + n) % n; };
  const float x = uv.x() * static_cast<float>(texture.size.width) - 0.5F;
  const float y = uv.y() * static_cast<float>(texture.size.height) - 0.5F;
  const float fx = std::floor(x), fy = std::floor(y);
  Vec3 sum = Vec3::Zero();
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const Rgb8 c = texture.at(wrap(static_cast<int>(fx) + i, texture.size.width),
                                wrap(static_cast<int>(fy) + j, texture.size.height));
      const float weight = (i == 1 ? x - fx : 1 - x + fx) * (j == 1 ? y - fy : 1 - y + fy);
      sum += weight * Vec3(linear_from_srgb(c.r), linear_from_srgb(c.g), linear_from_srgb(c.b));
    }
  return sum;
}

}  // namespace mixrig::studio
