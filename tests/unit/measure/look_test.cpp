// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/look.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

constexpr Size kLookSize{96, 64};

std::uint8_t look_byte(double v) {
  return static_cast<std::uint8_t>(std::lround(std::min(255.0, std::max(0.0, v))));
}

/// Left half room, right half object; both have an upright step 20 px from their left border.
struct LookScene {
  Image<Rgb8> truth{kLookSize}, color{kLookSize};
  Image<float> depth{kLookSize, 2}, light{kLookSize, 1};
  Image<std::uint8_t> matte{kLookSize}, labels{kLookSize}, layer{kLookSize};

  static double shade(int x) { return x % 48 < 20 ? 80 : 140; }
  /// Noise of this sigma, and a step that is so many pixels wide, in the room and on the object.
  LookScene(double real_noise, double virtual_noise, int real_px, int virtual_px,
            unsigned frame = 5) {
    std::mt19937 random(frame);
    std::normal_distribution<double> normal;
    for (int y = 0; y < kLookSize.height; ++y)
      for (int x = 0; x < kLookSize.width; ++x) {
        const bool object = x >= 48;
        labels.at(x, y) = layer.at(x, y) = object ? kLayerVirtual : 0;
        truth.at(x, y) = {look_byte(shade(x)), look_byte(shade(x)), look_byte(shade(x))};
        double sum = 0;
        const int wide = object ? virtual_px : real_px;
        for (int i = -wide; i <= wide; ++i)
          sum += shade(std::clamp(x + i, object ? 48 : 0, object ? 95 : 47));
        const double mean = sum / (2 * wide + 1), noise = object ? virtual_noise : real_noise;
        color.at(x, y) = {look_byte(mean + noise * normal(random)),
                          look_byte(mean + noise * normal(random)),
                          look_byte(mean + noise * normal(random))};
      }
  }
  void judge(LookSums& sums) const {
    add_look({color, depth, matte, light, layer}, {truth, depth, matte, light, labels}, sums);
  }
  Errors::Look judged() const {
    LookSums sums;
    judge(sums);
    return look_of(sums);
  }
};

/// Measures of three frames with different noise.
Errors::Look look_of_noise(double real, double of_virtual) {
  LookSums sums;
  for (unsigned frame = 1; frame <= 3; ++frame)
    LookScene(real, of_virtual, 0, 0, frame).judge(sums);
  return look_of(sums);
}

TEST(Look, TellsTheNoiseOfRoomAndObject) {
  const Errors::Look look = look_of_noise(4, 2);
  EXPECT_NEAR(*look.real_noise, 4, 0.3);
  EXPECT_NEAR(*look.virtual_noise, 2, 0.2);
}

TEST(Look, TextureThatStaysIsNoNoise) {
  LookSums sums;
  for (int frame = 0; frame < 2; ++frame) LookScene(6, 6, 0, 0).judge(sums);
  EXPECT_EQ(look_of(sums).real_noise, 0.0);
  EXPECT_EQ(LookScene(6, 6, 0, 0).judged().real_noise, std::nullopt) << "of one frame";
}

TEST(Look, WhatMovesIsNotJudgedForNoise) {
  LookSums sums;
  LookScene scene(3, 3, 0, 0);
  scene.judge(sums);
  for (int y = 0; y < kLookSize.height; ++y)
    for (int x = 0; x < kLookSize.width; ++x) scene.truth.at(x, y).g += 9;
  scene.judge(sums);
  EXPECT_EQ(look_of(sums).real_noise, std::nullopt);
}

TEST(Look, TellsHowSharpStepsAre) {
  const Errors::Look look = LookScene(0, 0, 1, 0).judged();
  // Over three pixels a step has a third of its height a pixel, two thirds beside the border.
  EXPECT_NEAR(*look.real_sharpness, 2.0 / 3, 0.02);
  EXPECT_NEAR(*look.virtual_sharpness, 1, 0.02);
  EXPECT_NEAR(*LookScene(6, 6, 1, 0).judged().real_sharpness, 2.0 / 3, 0.05) << "noise counts";
}

TEST(Look, WithoutAnObjectOnlyTheRoomIsTold) {
  LookScene scene(3, 3, 0, 0);
  scene.layer.fill(0), scene.labels.fill(0);
  const Errors::Look look = scene.judged();
  EXPECT_EQ(look.virtual_sharpness, std::nullopt);
  EXPECT_TRUE(look.real_sharpness);
}

TEST(Look, PeopleAreNotJudged) {
  LookScene scene(3, 3, 0, 0);
  scene.matte.fill(255);
  for (int y = 0; y < kLookSize.height; ++y)
    for (int x = 0; x < 48; ++x) scene.labels.at(x, y) = scene.layer.at(x, y) = 1;
  EXPECT_EQ(scene.judged().real_sharpness, std::nullopt);
  EXPECT_EQ(scene.judged().outline_sharpness, std::nullopt);
}

}  // namespace
}  // namespace mixrig::measure
