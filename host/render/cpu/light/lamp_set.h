// SPDX-License-Identifier: Apache-2.0
// Sets of lamps, by index.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mixrig::render::cpu {

/// Lamps that may be hidden, one bit a lamp; lamps beyond kLampBits always may be.
using LampSet = std::uint64_t;
inline constexpr std::size_t kLampBits = 64;
inline bool holds(LampSet set, std::size_t lamp) {
  return lamp >= kLampBits || (set >> lamp & 1) != 0;
}
inline constexpr LampSet kAllLamps = ~LampSet{0};

}  // namespace mixrig::render::cpu
