// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/srgb.h"

#include <cmath>

#include "hal/base/srgb.h"

namespace mixrig::render::cpu {

const std::array<std::uint16_t, 256>& srgb_to_linear() {
  static const auto kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double linear = linear_from_srgb(static_cast<double>(i) / 255);
      table[i] = static_cast<std::uint16_t>(std::lround(65535 * linear));
    }
    return table;
  }();
  return kTable;
}

}  // namespace mixrig::render::cpu
