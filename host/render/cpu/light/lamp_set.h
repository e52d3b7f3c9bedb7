// SPDX-License-Identifier: Apache-2.0
// Sets of lamps, by their number.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mixrig::render::cpu {

/// Lamps that may be hidden, by bit; those without a bit of their own always may.
using LampSet = std::uint64_t;
inline constexpr std::size_t kLampBits = 64;
inline bool holds(LampSet set, std::size_t lamp) {
  return lamp >= kLampBits || (set >> lamp & 1) != 0;
}
inline constexpr LampSet kAllLamps = ~LampSet{0};

}  // namespace mixrig::render::cpu
