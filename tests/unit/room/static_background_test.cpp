// SPDX-License-Identifier: Apache-2.0
// Learning a background from frames whose truth is known.
#include "host/room/background/static_background.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::model {
namespace {

constexpr Size kSize{24, 16};
const geometry::Pinhole kPlateView{kSize, 30, 30, 11.5, 7.5};

struct Frame {
  Image<float> depth_m{kSize};
  Image<Rgb8> color{kSize};
};

/// A wall at 2 m with noise of 10 mm, grey 100 with noise of 3 steps.
Frame noisy_wall(std::mt19937& random) {
  std::normal_distribution<float> depth(2.0F, 0.01F), gray(100.0F, 3.0F);
  Frame frame;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      frame.depth_m.at(x, y) = depth(random);
      const auto value = static_cast<std::uint8_t>(std::lround(gray(random)));
      frame.color.at(x, y) = {value, value, value};
    }
  return frame;
}

/// The sRGB curve, written independently so that the room's own table is tested.
float linear(double srgb) {
  return static_cast<float>(std::pow((srgb / 255 + 0.055) / 1.055, 2.4));
}

StaticBackground learned(StaticBackgroundBuilder& builder) {
  auto result = builder.finish();
  EXPECT_TRUE(result) << result.error().context;
  return result ? *std::move(result) : StaticBackground();
}

TEST(StaticBackground, CentreAndSpreadAreThoseOfTheNoise) {
  std::mt19937 random(1);
  StaticBackgroundBuilder builder(kPlateView);
  for (int i = 0; i < 30; ++i) {
    const Frame frame = noisy_wall(random);
    ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  }
  const StaticBackground background = learned(builder);
  EXPECT_EQ(background.frames, 30);
  double depth_sum = 0, sigma_sum = 0, color_sigma_sum = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      EXPECT_NEAR(background.depth_m.at(x, y), 2.0, 0.012);
      EXPECT_NEAR(background.color.at(x, y).g, linear(100), 0.02);
      depth_sum += background.depth_m.at(x, y);
      sigma_sum += background.depth_sigma_m.at(x, y);
      color_sigma_sum += background.color_sigma.at(x, y);
    }
  const double pixels = static_cast<double>(kSize.area());
  EXPECT_NEAR(depth_sum / pixels, 2.0, 0.0005);
  EXPECT_NEAR(sigma_sum / pixels, 0.01, 0.001);
  // Three steps of sRGB about 100 in linear light.
  const double expected = (linear(103) - linear(97)) / 2;
  EXPECT_NEAR(color_sigma_sum / pixels, expected, 0.15 * expected);
}

TEST(StaticBackground, APersonInAMinorityOfTheFramesDoesNoHarm) {
  std::mt19937 random(2);
  StaticBackgroundBuilder builder(kPlateView);
  for (int i = 0; i < 25; ++i) {
    Frame frame = noisy_wall(random);
    for (int x = i; x < i + 10; ++x)  // walks through; no pixel is covered in more than 10 of 25
      for (int y = 0; y < kSize.height && x < kSize.width; ++y) {
        frame.depth_m.at(x, y) = 1.0F;
        frame.color.at(x, y) = {250, 20, 20};
      }
    ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  }
  const StaticBackground background = learned(builder);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      EXPECT_NEAR(background.depth_m.at(x, y), 2.0, 0.03);
      EXPECT_LT(background.depth_sigma_m.at(x, y), 0.08);
      EXPECT_NEAR(background.color.at(x, y).r, linear(100), 0.05);
    }
}

/// People stand at other places, in most of the frames; the wall is what most frames agree on.
TEST(StaticBackground, PeopleInMostOfTheFramesAreLeftOutWhereTheyMove) {
  std::mt19937 random(5);
  StaticBackgroundBuilder builder(kPlateView);
  constexpr int kFrames = 30;
  for (int i = 0; i < kFrames; ++i) {
    Frame frame = noisy_wall(random);
    for (int x = 0; x < 8; ++x)  // in 20 of 30 frames, at a different distance in each
      for (int y = 0; y < kSize.height; ++y)
        if (i % 3 != 0) {
          frame.depth_m.at(x, y) = 0.5F + 0.04F * static_cast<float>(i);
          frame.color.at(x, y) = {250, 20, 20};
        }
    for (int x = 12; x < 16; ++x)  // one stands still in half of the frames
      for (int y = 0; y < kSize.height; ++y)
        if (i % 2 == 0) frame.depth_m.at(x, y) = 1.2F, frame.color.at(x, y) = {20, 250, 20};
    for (int y = 0; y < kSize.height; ++y)  // a window with somebody before it now and then
      frame.depth_m.at(20, y) = i < 12 ? 0.5F + 0.1F * static_cast<float>(i) : 0;
    ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  }
  const StaticBackground background = learned(builder);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      EXPECT_NEAR(background.depth_m.at(x, y), x == 20 ? 0.0 : 2.0, 0.03) << x;
      if (x == 20) continue;
      EXPECT_NEAR(background.color.at(x, y).r, linear(100), 0.05) << x;
    }
  EXPECT_NEAR(background.covered_share, 13.0 / kSize.width, 1e-9) << "with the window";
  EXPECT_NEAR(background.unseen_share, 1.0 / kSize.width, 1e-9);
}

TEST(StaticBackground, WhoStandsStillInNearlyAllFramesIsTakenForTheRoom) {
  StaticBackgroundBuilder builder(kPlateView);
  for (int i = 0; i < 20; ++i) {
    Frame frame;
    frame.depth_m.fill(i < 18 ? 1.0F : 2.0F);
    ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  }
  EXPECT_NEAR(learned(builder).depth_m.at(3, 3), 1.0, 1e-3);
}

TEST(StaticBackground, APixelMeasuredInFewerThanAThirdOfTheFramesIsUnknown) {
  StaticBackgroundBuilder builder(kPlateView);
  for (int i = 0; i < 9; ++i) {
    Frame frame;
    frame.depth_m.fill(3.0F);
    frame.depth_m.at(0, 0) = i < 2 ? 3.0F : 0.0F;
    frame.depth_m.at(1, 0) = i < 3 ? 3.0F : 0.0F;
    frame.depth_m.at(2, 0) = i % 2 == 0 ? 3.0F : std::nanf("");
    frame.depth_m.at(3, 0) = -1.0F;
    ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  }
  const StaticBackground background = learned(builder);
  EXPECT_EQ(background.depth_m.at(0, 0), 0.0F);
  EXPECT_EQ(background.depth_sigma_m.at(0, 0), 0.0F);
  EXPECT_FLOAT_EQ(background.depth_m.at(1, 0), 3.0F);
  EXPECT_FLOAT_EQ(background.depth_m.at(2, 0), 3.0F);
  EXPECT_EQ(background.depth_m.at(3, 0), 0.0F);
  EXPECT_GT(background.depth_sigma_m.at(4, 4), 0.0F)
      << "equal values still have their step's spread";
}

TEST(StaticBackground, MoreFramesThanFitAreSpreadOverAllOfThem) {
  // Depth grows evenly by 0.1 m: so must that of the kept frames.
  StaticBackgroundBuilder builder(kPlateView, 16);
  for (int i = 0; i < 100; ++i) {
    Frame frame;
    frame.depth_m.fill(1.0F + 0.001F * static_cast<float>(i));
    ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  }
  const StaticBackground background = learned(builder);
  EXPECT_LE(background.frames, 16);
  EXPECT_GE(background.frames, 8);
  EXPECT_NEAR(background.depth_m.at(5, 5), 1.05, 0.005);
  // Deviations of an even spread over 0.1 m have the median 0.025 m.
  EXPECT_NEAR(background.depth_sigma_m.at(5, 5), 1.4826 * 0.025, 0.008);
}

/// Frames of a camera that moves see parts of the view: a pixel is learned from those that saw it.
TEST(StaticBackground, OfDifferentViewsEachFrameTellsOfWhatItSaw) {
  StaticBackgroundBuilder builder(kPlateView, 32, Views::kDifferent);
  for (int i = 0; i < 6; ++i) {
    Frame frame;
    // Frame i sees the columns from 3 i to 3 i + 8, without the first and the last row.
    for (int y = 1; y < kSize.height - 1; ++y)
      for (int x = 3 * i; x < 3 * i + 9; ++x) {
        const auto value = static_cast<std::uint8_t>(100 + x);
        frame.depth_m.at(x, y) = 2 + 0.01F * static_cast<float>(x);
        frame.color.at(x, y) = {value, value, static_cast<std::uint8_t>(100 + y)};
      }
    ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  }
  ASSERT_TRUE(builder.add(Frame().depth_m, Frame().color));  // one that saw nothing
  const StaticBackground background = learned(builder);
  EXPECT_EQ(background.frames, 7);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      // Three frames see the columns from 6 to 17.
      const bool known = y > 0 && y < kSize.height - 1 && x >= 6 && x < 18;
      if (!known) {
        EXPECT_EQ(background.depth_m.at(x, y), 0) << x << "," << y;
        EXPECT_LT(background.color.at(x, y).r, 0) << x << "," << y;
        continue;
      }
      EXPECT_NEAR(background.depth_m.at(x, y), 2 + 0.01F * static_cast<float>(x), 2e-4);
      EXPECT_NEAR(background.color.at(x, y).g, linear(100 + x), 1e-4);
      EXPECT_NEAR(background.color.at(x, y).b, linear(100 + y), 1e-4);
    }
}

TEST(StaticBackground, TooLittleToLearnFromIsAnError) {
  StaticBackgroundBuilder builder(kPlateView);
  Frame frame;
  EXPECT_EQ(builder.add(Image<float>(Size{5, 5}), frame.color).error().code, ErrorCode::kData);
  ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  EXPECT_EQ(builder.finish().error().code, ErrorCode::kData);
  ASSERT_TRUE(builder.add(frame.depth_m, frame.color));
  const auto unknown = builder.finish();
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().context.find("no pixel"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::model
