// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixrig::measure {
namespace {

float decoded(float v) {
  return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

std::array<float, 256> table() {
  std::array<float, 256> out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = decoded(static_cast<float>(i) / 255.0F);
  return out;
}

}  // namespace

float linear_of(std::uint8_t srgb) {
  static const std::array<float, 256> kTable = table();
  return kTable[srgb];
}

std::uint8_t srgb_of(float linear) {
  const float v = std::clamp(linear, 0.0F, 1.0F);
  const float code = v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(255.0F * code));
}

}  // namespace mixrig::measure
