// SPDX-License-Identifier: Apache-2.0
// Plots bars that consist of parts, such as the stages of a delay.
#pragma once

#include <string>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::report {

struct BarPart {
  /// Parts with the same name have the same colour, in the order of the first bar.
  std::string name;
  double value = 0;  ///< not negative
};
struct Bar {
  std::string name;
  std::vector<BarPart> parts;  ///< from left to right
};
struct BarPlot {
  std::string title, unit;
  std::vector<Bar> bars;  ///< from top to bottom
};

/// Draws the plot. The axis starts at zero and ends at a round number above the longest bar.
Image<Rgb8> draw_bars(const BarPlot& plot, Size size);

}  // namespace mixrig::report
