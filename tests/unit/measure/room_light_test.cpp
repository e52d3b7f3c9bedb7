// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/room_light.h"

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

constexpr Size kRoom{64, 32};

Image<float> filled(float value) {
  Image<float> picture(kRoom);
  for (int y = 0; y < kRoom.height; ++y)
    for (int x = 0; x < kRoom.width; ++x) picture.at(x, y) = value;
  return picture;
}

/// Rows 8 to 23: a lamp of 5 at columns 0 to 15, a wall of 0.5 elsewhere.
Image<float> room() {
  Image<float> picture = filled(0.5F);
  for (int y = 8; y < 24; ++y)
    for (int x = 0; x < 16; ++x) picture.at(x, y) = 5;
  return picture;
}

TEST(RoomLight, ErrorsAreOfTheSurfaceThatIsThere) {
  Image<float> model = room();
  for (int y = 8; y < 24; ++y)
    for (int x = 0; x < 16; ++x) model.at(x, y) *= 1.1F;
  const Image<float> none = filled(0), truth = room();
  const auto errors = room_light_errors(model.view(), none.view(), truth.view());
  EXPECT_EQ(errors.lamps.places, 10U * 10U) << "three pixels from the border on";
  EXPECT_NEAR(errors.lamps.p50_pct, 10, 0.01);
  EXPECT_NEAR(errors.lamps.bias_pct, 10, 0.01);
  EXPECT_NEAR(errors.bright.p95_pct, 0, 0.01);
  EXPECT_EQ(errors.dim.places, 0U);
}

TEST(RoomLight, WhatIsSaturatedOrUnknownIsNotAnError) {
  Image<float> model = room();
  Image<float> saturated = filled(0);
  const Image<float> truth = room();
  for (int y = 8; y < 16; ++y)
    for (int x = 0; x < 16; ++x) model.at(x, y) = 1, saturated.at(x, y) = 1;
  for (int x = 30; x < 40; ++x)
    for (int y = 0; y < 32; ++y) model.at(x, y) = -1;
  const auto errors =
      room_light_errors(model.view(), std::as_const(saturated).view(), truth.view());
  EXPECT_NEAR(errors.lamps.saturated_pct, 50, 0.1);
  EXPECT_NEAR(errors.lamps.p95_pct, 0, 0.01);
  EXPECT_NEAR(errors.bright.p95_pct, 0, 0.01);
}

}  // namespace
}  // namespace mixrig::measure
