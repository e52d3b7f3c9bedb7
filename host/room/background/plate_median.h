// SPDX-License-Identifier: Apache-2.0
// Combines the pictures of a view's frames into one, without passers-by.
#pragma once

#include <vector>

#include "hal/base/image.h"
#include "hal/base/parallel.h"

namespace mixrig::model {

/// Median of each pixel and channel over the frames of a view: removes what less than half of the
/// frames show, and lowers noise. Uses the first kMostPlates of more frames, and the first of two.
/// Not thread-safe; keeps its memory for the next view.
class PlateMedian {
 public:
  static constexpr std::size_t kMostPlates = 9;

  void clear() { count_ = 0; }
  /// Adds a picture; all must have one size.
  void add(ImageView<const Rgb8> plate);
  /// Writes the median of each channel; of an even count the mean of the two middle values, rounded
  /// up.
  void finish(Image<Rgb8>& plate, Crew& crew) const;

 private:
  std::vector<Image<Rgb8>> plates_;
  std::size_t count_ = 0;
};

}  // namespace mixrig::model
