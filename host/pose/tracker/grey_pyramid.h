// SPDX-License-Identifier: Apache-2.0
// An image pyramid of grey pictures.
#pragma once

#include <cstddef>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/parallel.h"

namespace mixrig::tracking {

/// Level 0 has the picture's size, each other level half that of the level before, rounded down.
/// Pixel x of level k covers pixels 2^k x to 2^k (x + 1) - 1. Values are luma (Rec. 601) of the
/// sRGB values, 0 to 255.
class GreyPyramid {
 public:
  /// Builds the levels; keeps its memory while size and number stay. Stops before a side is below
  /// 16 pixels.
  void build(ImageView<const Rgb8> picture, int levels, Crew& crew);

  int levels() const { return static_cast<int>(levels_.size()); }
  const Image<float>& level(int k) const { return levels_[static_cast<std::size_t>(k)]; }

 private:
  std::vector<Image<float>> levels_;
};

/// Converts a coordinate of level 0 to level k, and back.
inline double down(double px, int k) { return (px + 0.5) / (1 << k) - 0.5; }
inline double up(double px, int k) { return (px + 0.5) * (1 << k) - 0.5; }

}  // namespace mixrig::tracking
