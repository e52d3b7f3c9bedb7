// SPDX-License-Identifier: Apache-2.0
// Pictures made of a formula.
#pragma once

#include "studio/srgb.h"

namespace mixrig::studio {

/// Paints a picture by color(u, v): linear, at pixel centres, u and v within 0..1.
template <typename Color>
Image<Rgb8> paint(Size size, Color&& color) {
  Image<Rgb8> image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      image.at(x, y) =
          srgb_from_linear(color((static_cast<float>(x) + 0.5F) / static_cast<float>(size.width),
                                 (static_cast<float>(y) + 0.5F) / static_cast<float>(size.height)));
  return image;
}

}  // namespace mixrig::studio
