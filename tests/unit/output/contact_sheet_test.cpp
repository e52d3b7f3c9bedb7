// SPDX-License-Identifier: Apache-2.0
#include "host/output/sheet/contact_sheet.h"

#include <utility>

#include <gtest/gtest.h>

namespace mixrig::output {
namespace {

TEST(Spread, TakesTheMiddleOfEqualParts) {
  EXPECT_EQ(spread(1, 100, 4), (std::vector<int>{13, 38, 63, 88}));
  EXPECT_EQ(spread(5, 7, 6), (std::vector<int>{5, 6, 7}));
  EXPECT_EQ(spread(9, 9, 3), (std::vector<int>{9}));
}

/// Number of red pixels of a sheet with one row, and its width.
std::pair<int, int> red_of_sheet(const std::optional<WrongPiece>& worst) {
  constexpr Size kView{400, 320};
  render::FrameOutput output;
  output.color.reset(kView, Rgb8{90, 90, 90});
  output.warped_depth_m.reset(kView, 2);
  output.state.reset(kView, static_cast<std::uint8_t>(render::PixelState::kBackground));
  output.light.reset(kView, 1);
  const Image<Rgb8> plate(kView, Rgb8{90, 90, 90});
  for (int y = 200; y < 204; ++y)
    for (int x = 300; x < 310; ++x) output.color.at(x, y) = {255, 0, 0};
  ContactSheet sheet("title");
  sheet.add_row(1, plate, output, plate, worst);
  const Image<Rgb8> drawn = sheet.draw();
  int red = 0;
  for (int y = 0; y < drawn.height(); ++y)
    for (int x = 0; x < drawn.width(); ++x) red += drawn.at(x, y) == Rgb8{255, 0, 0};
  return {red, drawn.width()};
}

TEST(ContactSheet, ShowsTheLargestWrongPieceEnlarged) {
  const auto [red, width] = red_of_sheet(std::nullopt);
  const auto [red_judged, width_judged] = red_of_sheet(WrongPiece{40, 300, 200, 10, 4});
  EXPECT_EQ(red_judged - red, 40 * 6 * 6) << "only in the composite's half";
  EXPECT_GT(width_judged, width + 300);
  EXPECT_EQ(red_of_sheet(WrongPiece{}).first, red) << "no piece, nothing enlarged";
}

}  // namespace
}  // namespace mixrig::output
