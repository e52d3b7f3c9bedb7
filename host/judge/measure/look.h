// SPDX-License-Identifier: Apache-2.0
// Judges whether virtual objects are as noisy and as sharp as the camera shows real ones.
// docs/reference/measures.md defines the measures.
#pragma once

#include <array>

#include "host/judge/measure/errors.h"

namespace mixrig::measure {

/// Running sums over the frames of a run, and the last frame's images.
struct LookSums {
  static constexpr std::size_t kBins = 16;  ///< classes of true luma
  std::array<Sum, kBins> real_noise, virtual_noise;
  /// Regression of the composite's gradient on the true one: sums of products, and of squares of
  /// the true one.
  struct Slope {
    double products = 0, squares = 0;
  };
  Slope real, virtual_inside, outline;
  Image<Rgb8> last_color, last_truth;
  Image<std::uint8_t> last_labels;
};

/// Adds a frame. Precondition: add_frame() took it.
void add_look(const ResultImages& result, const TruthImages& truth, LookSums& sums);
Errors::Look look_of(const LookSums& sums);

}  // namespace mixrig::measure
