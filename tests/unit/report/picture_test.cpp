// SPDX-License-Identifier: Apache-2.0
#include "host/output/report/picture.h"

#include <limits>

#include <gtest/gtest.h>

#include "host/output/report/canvas.h"
#include "host/output/report/plot.h"
#include "tests/support/each_pixel.h"

namespace mixrig::report {
namespace {

TEST(Shrunk, AveragesWhatAPixelCovers) {
  Image<Rgb8> in({4, 2});
  for (int x = 0; x < 4; ++x) in.at(x, 0) = {static_cast<std::uint8_t>(10 * x), 0, 100};
  const Image<Rgb8> out = shrunk(in, {2, 1});
  EXPECT_EQ(out.at(0, 0), (Rgb8{2, 0, 50}));   // (0 + 10) / 4
  EXPECT_EQ(out.at(1, 0), (Rgb8{12, 0, 50}));  // (20 + 30) / 4
}

TEST(Shrunk, RepeatsPixelsOfASmallerPicture) {
  Image<Rgb8> in({1, 1}, Rgb8{7, 8, 9});
  EXPECT_EQ(shrunk(in, {3, 2}).at(2, 1), (Rgb8{7, 8, 9}));
}

TEST(DepthPicture, ShowsUnknownAsBlackAndNearWarmerThanFar) {
  Image<float> depth({3, 1});
  depth.at(1, 0) = 1.0F;
  depth.at(2, 0) = 4.0F;
  const Image<Rgb8> out = depth_picture(depth, 1.0F, 4.0F);
  EXPECT_EQ(out.at(0, 0), Rgb8{});
  EXPECT_GT(out.at(1, 0).r, out.at(1, 0).b);
  EXPECT_GT(out.at(2, 0).b, out.at(2, 0).r);
}

TEST(ErrorPicture, IsWhiteAtZeroRedAtTheMostBlackWhereUnknownWithAScaleBelow) {
  Image<float> error({640, 2}, 0.0F);
  error.at(1, 0) = 10.0F, error.at(2, 0) = 400.0F, error.at(3, 0) = -1.0F;
  error.at(4, 0) = std::numeric_limits<float>::quiet_NaN();
  const Image<Rgb8> out = error_picture(error, 40.0F, "mm");
  EXPECT_EQ(out.width(), 640);
  EXPECT_GT(out.height(), 2);
  EXPECT_EQ(out.at(0, 0), (Rgb8{255, 255, 255}));
  EXPECT_EQ(out.at(2, 0), (Rgb8{204, 38, 0}));
  EXPECT_GT(out.at(1, 0).g, out.at(2, 0).g);  // a quarter of the largest: half way
  EXPECT_EQ(out.at(3, 0), Rgb8{});
  EXPECT_EQ(out.at(4, 0), Rgb8{});
}

TEST(TickStep, IsARoundNumberWithAtMostEightTicks) {
  EXPECT_DOUBLE_EQ(tick_step(8.0), 1.0);
  EXPECT_DOUBLE_EQ(tick_step(9.0), 2.0);
  EXPECT_DOUBLE_EQ(tick_step(35.0), 5.0);
  EXPECT_DOUBLE_EQ(tick_step(0.03), 0.005);
  EXPECT_DOUBLE_EQ(tick_step(0.0), 1.0);
}

TEST(Canvas, KeepsPicturesToTheByteAndClipsThem) {
  Canvas canvas({4, 3}, {255, 255, 255});
  Image<Rgb8> dot({3, 3}, Rgb8{1, 2, 3});
  canvas.picture(2, -1, dot);
  const Image<Rgb8> out = canvas.finish();
  EXPECT_EQ(out.at(3, 1), (Rgb8{1, 2, 3}));
  EXPECT_EQ(out.at(1, 1), (Rgb8{255, 255, 255}));
  EXPECT_EQ(out.at(3, 2), (Rgb8{255, 255, 255}));
}

TEST(Canvas, DrawsEachShapeByItself) {
  Canvas canvas({100, 40}, {255, 255, 255});
  canvas.text({2, 38}, "x", 10, {});
  canvas.line({{90, 2}, {90, 20}}, 2, {});
  canvas.text({2, 38}, "x", 10, {});
  canvas.dot({70, 5}, 3, {});
  const Image<Rgb8> out = canvas.finish();
  for (const auto [x, y] : test::each_pixel({20, 0}, {60, 40}))
    ASSERT_EQ(out.at(x, y), (Rgb8{255, 255, 255})) << x << ' ' << y;
  EXPECT_EQ(out.at(70, 5), Rgb8{});
  EXPECT_EQ(out.at(90, 10), Rgb8{});
}

TEST(Plot, DrawsItsPointsAndSurvivesNone) {
  const Plot plot{"t", "x", "y", {{"s", {{1, 2, "a"}, {3, 4, "b"}}}, {"none", {}}}};
  const Image<Rgb8> out = draw(plot, {320, 240});
  int colored = 0;
  for (const auto [x, y] : test::each_pixel(out)) colored += out.at(x, y) == Rgb8{31, 119, 180};
  EXPECT_GT(colored, 50);
  EXPECT_EQ(draw({}, {100, 80}).size(), (Size{100, 80}));
}

}  // namespace
}  // namespace mixrig::report
