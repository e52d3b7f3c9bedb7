// SPDX-License-Identifier: Apache-2.0
// A pair of views for two eyes, drawn from one picture, its depth, and what lies behind it.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::output {

struct StereoOptions {
  double fx_px = 0;      ///< of the picture's pinhole
  double eye_m = 0.065;  ///< between the two views
  double screen_m = 3;   ///< distance without disparity
  double most_px = 1e9;  ///< disparity before and behind the screen is cut at this
};

/// A picture with depth; 0 is unknown. Sizes agree.
struct DepthPicture {
  ImageView<const Rgb8> color;
  ImageView<const float> depth_m;
};

/// How the pixels of both views came about.
struct StereoCounts {
  std::uint64_t seen = 0;     ///< by the picture
  std::uint64_t behind = 0;   ///< of what lies behind it
  std::uint64_t guessed = 0;  ///< neither: the farther neighbour in the row
};

/// Left and right view, 2 columns of `out` each as wide as the picture: each point is moved by half
/// of fx eye (1/z - 1/screen) against the eye. Surfaces are torn where their disparity changes by
/// more than 2 px from pixel to pixel; the hole shows what lies behind (may be empty). A depth that
/// is not known is that of the farther known neighbour in its row.
class StereoPair {
 public:
  explicit StereoPair(StereoOptions options) : options_(options) {}
  StereoCounts draw(const DepthPicture& picture, const DepthPicture& behind, Image<Rgb8>& out);

 private:
  struct Row {
    std::vector<float> w;  ///< 1/z of what was drawn, 0 nothing
    std::vector<Rgb8> color;
  };
  /// `all`: also where the depth is not known.
  void move_row(const DepthPicture& from, int y, float side, bool all, Row& row);
  float disparity_px(float w) const;

  StereoOptions options_;
  Row front_, back_;
  std::vector<float> known_w_;
};

}  // namespace mixrig::output
