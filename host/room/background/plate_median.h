// SPDX-License-Identifier: Apache-2.0
// One colour picture from those of a view's frames, without who walked through.
#pragma once

#include <vector>

#include "hal/base/image.h"
#include "hal/base/parallel.h"

namespace mixrig::model {

/// Median of each pixel and channel over the frames of a view: what is in less than half of them is
/// not in it, and noise is lower. Of many frames the first kMostPlates count, of two the first. Not
/// thread-safe; its memory is kept for the next view.
class PlateMedian {
 public:
  static constexpr std::size_t kMostPlates = 9;

  void clear() { count_ = 0; }
  /// Pictures of one size.
  void add(ImageView<const Rgb8> plate);
  /// Of an even count the mean of the two middle values, rounded up.
  void finish(Image<Rgb8>& plate, Crew& crew) const;

 private:
  std::vector<Image<Rgb8>> plates_;
  std::size_t count_ = 0;
};

}  // namespace mixrig::model
