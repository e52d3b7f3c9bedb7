// SPDX-License-Identifier: Apache-2.0
// Plots named points, such as speed against error.
#pragma once

#include <string>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::report {

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;  ///< written beside the dot
};
/// Points of one colour, joined by a line in the given order.
struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
};
struct Plot {
  std::string title, x_label, y_label;
  std::vector<PlotSeries> series;
  bool log_x = false;  ///< decades, from the one below the least x on
  bool joined = true;  ///< a line joins the points of a series
};

/// Draws the plot. Axes start at zero and end at a round number above the largest value. Points
/// that are negative or not finite are left out; with `log_x` also points at zero.
Image<Rgb8> draw(const Plot& plot, Size size);
/// Draws the plot as an SVG file.
std::string draw_svg(const Plot& plot, Size size);

/// Step between ticks at which at most eight cover 0..`largest`: 1, 2 or 5 times a power of ten.
double tick_step(double largest);

}  // namespace mixrig::report
