// SPDX-License-Identifier: Apache-2.0
// Caches what a camera sees behind the board while the camera stands still.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::studio {

/// Value behind the board for each requested pixel, kept until the camera turns. Threads may ask at
/// the same time for different pixels.
template <typename Value>
class BehindBoard {
 public:
  explicit BehindBoard(Size size) : values_(size.area()), known_(size.area(), 0) {}
  template <typename Find>
  const Value& at(std::size_t pixel, const Find& find) {
    if (known_[pixel] == 0) values_[pixel] = find();
    known_[pixel] = 1;
    return values_[pixel];
  }
  void forget() { std::fill(known_.begin(), known_.end(), std::uint8_t{0}); }

 private:
  std::vector<Value> values_;
  std::vector<std::uint8_t> known_;
};

}  // namespace mixrig::studio
