// SPDX-License-Identifier: Apache-2.0
// A plot of bars that are made of parts: the stages of a delay.
#pragma once

#include <string>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::report {

struct BarPart {
  std::string name;  ///< parts of one name have one colour, in the order of the first bar
  double value = 0;  ///< not negative
};
struct Bar {
  std::string name;
  std::vector<BarPart> parts;  ///< from left to right
};
struct BarPlot {
  std::string title, unit;
  std::vector<Bar> bars;  ///< below one another
};

/// The axis starts at zero and ends at a round number above the longest bar.
Image<Rgb8> draw_bars(const BarPlot& plot, Size size);

}  // namespace mixrig::report
