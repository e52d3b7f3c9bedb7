// SPDX-License-Identifier: Apache-2.0
// A picture from a function of (x, y).
#pragma once

#include "hal/base/image.h"

namespace mixrig::test {

template <typename T, typename Function>
Image<T> make_image(Size size, Function&& value) {
  Image<T> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) image.at(x, y) = value(x, y);
  return image;
}

}  // namespace mixrig::test
