// SPDX-License-Identifier: Apache-2.0
// Draws views for two eyes from a picture, its depth, and the room behind it.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::output {

struct StereoOptions {
  double fx_px = 0;      ///< of the picture's pinhole
  double eye_m = 0.065;  ///< distance between the eyes
  double screen_m = 3;   ///< distance without disparity
  double most_px = 1e9;  ///< limit of the disparity, before and behind the screen
};

/// A picture with depth (0 unknown) of the same size.
struct DepthPicture {
  ImageView<const Rgb8> color;
  ImageView<const float> depth_m;
};

/// How the pixels of both views were found.
struct StereoCounts {
  std::uint64_t seen = 0;     ///< from the picture
  std::uint64_t behind = 0;   ///< from the room behind it
  std::uint64_t guessed = 0;  ///< from neither: copied from the farther neighbour in the row
};

/// Draws the left and right view side by side in `out`, each as wide as the picture: a point is
/// moved by half of fx eye (1/z - 1/screen) against the eye. Surfaces are torn where neighbouring
/// pixels come 2.5 px or more apart, or swap places; the hole shows `behind` (may be empty). An
/// unknown depth is replaced by that of the farther known neighbour in its row.
class StereoPair {
 public:
  explicit StereoPair(StereoOptions options) : options_(options) {}
  StereoCounts draw(const DepthPicture& picture, const DepthPicture& behind, Image<Rgb8>& out);

 private:
  struct Row {
    std::vector<float> w;  ///< inverse depth of the drawn pixels, 0 nothing
    std::vector<Rgb8> color;
  };
  /// `all`: also draws pixels of unknown depth.
  void move_row(const DepthPicture& from, int y, float side, bool all, Row& row);
  float disparity_px(float w) const;

  StereoOptions options_;
  Row front_, back_;
  std::vector<float> known_w_;
};

}  // namespace mixrig::output
