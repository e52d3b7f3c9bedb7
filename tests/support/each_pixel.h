// SPDX-License-Identifier: Apache-2.0
// The pixels of a picture, row by row: for (const auto [x, y] : each_pixel(size)).
#pragma once

#include "hal/base/image.h"

namespace mixrig::test {

struct PixelPlace {
  int x = 0, y = 0;
};

/// Pixels from `from` to just before `to`, in x and in y.
class EachPixel {
 public:
  EachPixel(PixelPlace from, PixelPlace to) : from_(from), to_(to) {
    if (from.x >= to.x || from.y >= to.y) to_.y = from_.y;
  }
  struct Iterator {
    PixelPlace at;
    int first_x, end_x;
    PixelPlace operator*() const { return at; }
    Iterator& operator++() {
      if (++at.x == end_x) at = {first_x, at.y + 1};
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at.y != other.at.y; }
  };
  Iterator begin() const { return {from_, from_.x, to_.x}; }
  Iterator end() const { return {to_, from_.x, to_.x}; }

 private:
  PixelPlace from_, to_;
};

inline EachPixel each_pixel(PixelPlace from, PixelPlace to) { return {from, to}; }
inline EachPixel each_pixel(Size size) { return {{}, {size.width, size.height}}; }
template <typename T>
EachPixel each_pixel(const Image<T>& image) {
  return each_pixel(image.size());
}

}  // namespace mixrig::test
