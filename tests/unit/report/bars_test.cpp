// SPDX-License-Identifier: Apache-2.0
#include "host/output/report/bars.h"

#include <gtest/gtest.h>

namespace mixrig::report {
namespace {

int pixels_of(const Image<Rgb8>& picture, int row, Rgb8 color) {
  int count = 0;
  for (int x = 0; x < picture.width(); ++x) count += picture.at(x, row) == color ? 1 : 0;
  return count;
}

TEST(BarPlotTest, PartsAreAsLongAsTheirValues) {
  const BarPlot plot{
      .title = "delay",
      .unit = "ms",
      .bars = {{"one", {{"wait", 10}, {"compose", 30}}}, {"two", {{"compose", 20}, {"wait", 5}}}}};
  const Image<Rgb8> picture = draw_bars(plot, {610, 330});
  // 200 px of bars: one from 60 to 160, the other from 160 to 260.
  const Rgb8 wait{60, 110, 170}, compose{220, 140, 50};
  const int first = 110, second = 210;
  const double px_per_ms = pixels_of(picture, first, wait) / 10.0;
  EXPECT_GT(px_per_ms, 5);
  EXPECT_NEAR(pixels_of(picture, first, compose), 30 * px_per_ms, 2);
  EXPECT_NEAR(pixels_of(picture, second, compose), 20 * px_per_ms, 2);
  EXPECT_NEAR(pixels_of(picture, second, wait), 5 * px_per_ms, 2) << "a name has one colour";
}

TEST(BarPlotTest, NothingToDrawIsAnEmptyPlot) {
  EXPECT_EQ(draw_bars(BarPlot{}, {400, 200}).size(), (Size{400, 200}));
  EXPECT_EQ(draw_bars(BarPlot{.title = "", .unit = "", .bars = {{"none", {}}}}, {400, 200}).size(),
            (Size{400, 200}));
}

}  // namespace
}  // namespace mixrig::report
