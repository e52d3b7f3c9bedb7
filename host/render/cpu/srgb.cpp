// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/srgb.h"

#include <cmath>

namespace mixrig::render::cpu {

const std::array<std::uint16_t, 256>& srgb_to_linear() {
  static const auto kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double c = static_cast<double>(i) / 255;
      const double linear = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
      table[i] = static_cast<std::uint16_t>(std::lround(65535 * linear));
    }
    return table;
  }();
  return kTable;
}

const std::vector<std::uint8_t>& linear_to_srgb() {
  static const auto kTable = [] {
    std::vector<std::uint8_t> table(65536);
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double c = static_cast<double>(i) / 65535;
      const double code = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
      table[i] = static_cast<std::uint8_t>(std::lround(255 * code));
    }
    return table;
  }();
  return kTable;
}

}  // namespace mixrig::render::cpu
