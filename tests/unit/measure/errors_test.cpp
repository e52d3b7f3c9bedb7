// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/errors.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

/// A frame in which the composite is the truth: a wall at 2 m, no person, full light.
struct Frame {
  explicit Frame(Size size)
      : color(size, Rgb8{10, 20, 30}),
        true_color(size, Rgb8{10, 20, 30}),
        depth(size, 2.0F),
        true_depth(size, 2.0F),
        light(size, 1.0F),
        true_light(size, 1.0F),
        matte(size),
        true_matte(size),
        layer(size),
        labels(size, kTofSees) {}

  Result<void> add_to(ErrorSums& sums) const {
    return add_frame({color, depth, matte, light, layer},
                     {true_color, true_depth, true_matte, true_light, labels}, sums);
  }
  Errors errors() const {
    ErrorSums sums;
    EXPECT_TRUE(add_to(sums));
    return errors_of(sums);
  }

  Image<Rgb8> color, true_color;
  Image<float> depth, true_depth, light, true_light;
  Image<std::uint8_t> matte, true_matte, layer, labels;
};

TEST(Errors, OfAPerfectFrameAreZeroOrUndefined) {
  const Errors e = Frame({4, 4}).errors();
  EXPECT_EQ(e.depth_mae_mm, 0.0);
  EXPECT_EQ(e.depth_bad_pct, 0.0);
  EXPECT_EQ(e.matte_mse, 0.0);
  EXPECT_EQ(e.light_rmse, 0.0);
  EXPECT_EQ(e.color_psnr_db, kEqualPsnr_db);
  // No step, no person, nothing virtual and no shadow: the measures are null instead of 0/0.
  EXPECT_EQ(e.band_bad_pct, std::nullopt);
  EXPECT_EQ(e.key_iou, std::nullopt);
  EXPECT_EQ(e.order_wrong_pct, std::nullopt);
  EXPECT_EQ(e.light_shadow_rmse, std::nullopt);
  EXPECT_EQ(e.object_rmse, std::nullopt);
  EXPECT_EQ(e.object_psnr_db, std::nullopt);
}

TEST(Errors, WhatTheDepthCameraDoesNotSeeIsJudgedByItself) {
  Frame f({8, 1});
  for (int x = 0; x < 4; ++x) f.labels.at(x, 0) = 0;
  f.depth.at(0, 0) = 2.05F, f.depth.at(1, 0) = 0, f.depth.at(2, 0) = 3, f.depth.at(3, 0) = 1;
  const Errors e = f.errors();
  EXPECT_EQ(e.hidden_pct, 50.0);
  EXPECT_EQ(e.hidden_bad_pct, 75.0) << "unknown or off";
  EXPECT_EQ(e.hidden_wrong_pct, 50.0) << "known and off";
  EXPECT_EQ(e.depth_bad_pct, 0.0);
  EXPECT_EQ(Frame({4, 4}).errors().hidden_bad_pct, std::nullopt);
}

TEST(Errors, MixedDepthIsJudgedWhereBothShowWhatIsReal) {
  Frame f({8, 1});
  Image<float> mixed({8, 1}, 2.0F);
  for (int x = 0; x < 4; ++x) f.labels.at(x, 0) = 0;  // hidden
  mixed.at(0, 0) = 0, mixed.at(1, 0) = 1.5F, mixed.at(2, 0) = 2.05F;
  f.layer.at(6, 0) = kLayerVirtual, mixed.at(6, 0) = 1;    // virtual in the composite
  f.labels.at(7, 0) |= kLayerVirtual, mixed.at(7, 0) = 1;  // in the truth
  ErrorSums sums;
  ASSERT_TRUE(add_frame({f.color, f.depth, f.matte, f.light, f.layer, mixed},
                        {f.true_color, f.true_depth, f.true_matte, f.true_light, f.labels}, sums));
  const Errors e = errors_of(sums);
  EXPECT_NEAR(*e.mixed_bad_pct, 100.0 * 2 / 6, 1e-9) << "unknown or off";
  EXPECT_EQ(e.mixed_hidden_wrong_pct, 25.0) << "known and off";
  EXPECT_EQ(f.errors().mixed_bad_pct, std::nullopt) << "no mixed depth is given";
  const Image<float> small({4, 1}, 2.0F);
  EXPECT_FALSE(add_frame({f.color, f.depth, f.matte, f.light, f.layer, small},
                         {f.true_color, f.true_depth, f.true_matte, f.true_light, f.labels}, sums));
}

TEST(Errors, OfNoFrameAreUndefined) {
  const Errors e = errors_of({});
  EXPECT_EQ(e.depth_mae_mm, std::nullopt);
  EXPECT_EQ(e.matte_mse, std::nullopt);
  EXPECT_EQ(e.color_psnr_db, std::nullopt);
}

TEST(DepthError, CountsOnlyWhatTheTofCameraSees) {
  Frame f({4, 1});
  f.depth.at(0, 0) = 2.01F;  // 10 mm off
  f.depth.at(1, 0) = 2.13F;  // 130 mm off: bad
  f.depth.at(2, 0) = 0.0F;   // unknown: bad, but no millimetres
  f.depth.at(3, 0) = 5.0F;   // not seen: does not count
  f.labels.at(3, 0) = 0;
  const Errors e = f.errors();
  EXPECT_NEAR(*e.depth_mae_mm, 70.0, 1e-3);
  EXPECT_NEAR(*e.depth_bad_pct, 200.0 / 3.0, 1e-9);
}

TEST(DepthError, TakesNanAsUnknown) {
  Frame f({2, 1});
  f.depth.at(0, 0) = std::nanf("");
  const Errors e = f.errors();
  EXPECT_EQ(e.depth_mae_mm, 0.0);
  EXPECT_EQ(e.depth_bad_pct, 50.0);
}

TEST(BandError, CountsPixelsWithinEightOfAStep) {
  Frame f({40, 1});  // the step lies between 19 and 20: the band is 11..28
  for (int x = 20; x < 40; ++x) f.true_depth.at(x, 0) = f.depth.at(x, 0) = 3.0F;
  f.depth.at(10, 0) = 0.0F;  // outside
  f.depth.at(11, 0) = 0.0F;
  f.depth.at(28, 0) = 0.0F;
  f.depth.at(29, 0) = 0.0F;  // outside
  const Errors e = f.errors();
  EXPECT_DOUBLE_EQ(*e.band_bad_pct, 100.0 * 2 / 18);
  EXPECT_DOUBLE_EQ(*e.depth_bad_pct, 100.0 * 4 / 40);
}

TEST(StepBand, IsADiscAndNeedsMoreThanTheStep) {
  Image<float> depth({7, 7}, 1.0F);
  depth.at(3, 3) = 1.09F;
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 7; ++x) EXPECT_EQ(step_band(depth, 0.1F, 2).at(x, y), 0);
  depth.at(3, 3) = 2.0F;  // marks itself and its four neighbours
  const Image<std::uint8_t> band = step_band(depth, 0.1F, 2);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 7; ++x) {
      bool near = false;
      for (const auto& [u, v] : {std::pair{3, 3}, {2, 3}, {4, 3}, {3, 2}, {3, 4}})
        near = near || std::hypot(x - u, y - v) <= 2.0;
      EXPECT_EQ(band.at(x, y), near ? 1 : 0) << x << ' ' << y;
    }
  }
}

TEST(StepBand, UnknownDepthMakesNoStep) {
  Image<float> depth({5, 1}, 1.0F);
  depth.at(2, 0) = 0.0F;
  for (int x = 0; x < 5; ++x) EXPECT_EQ(step_band(depth, 0.1F, 1).at(x, 0), 0);
}

TEST(KeyIou, CutsBothMasksAtHalfAndSumsOverFrames) {
  Frame f({4, 1});
  f.matte.at(0, 0) = 255;
  f.true_matte.at(0, 0) = 128;
  f.matte.at(1, 0) = 127;  // just under half
  f.true_matte.at(1, 0) = 200;
  Frame g({4, 1});
  g.matte.at(2, 0) = g.true_matte.at(2, 0) = 255;
  ErrorSums sums;
  ASSERT_TRUE(f.add_to(sums));
  ASSERT_TRUE(g.add_to(sums));
  // The mean of the frames would be (1/2 + 1/1) / 2.
  EXPECT_DOUBLE_EQ(*errors_of(sums).key_iou, 2.0 / 3.0);
}

TEST(MatteError, IsTheMeanSquareOfCoverage) {
  Frame f({2, 1});
  f.matte.at(0, 0) = 255;
  f.true_matte.at(0, 0) = 204;  // 0.8
  EXPECT_NEAR(*f.errors().matte_mse, 0.02, 1e-9);
}

TEST(OrderError, JudgesTheUnionOfCompositeAndTrueSilhouette) {
  Frame f({5, 1});
  f.layer.at(0, 0) = 2, f.labels.at(0, 0) = kInSilhouette | 2;  // right: virtual before all
  f.layer.at(1, 0) = 1, f.labels.at(1, 0) = kInSilhouette | 1;  // right: occluded by a person
  f.layer.at(2, 0) = 2, f.labels.at(2, 0) = 0;                  // wrong: virtual where none is
  f.layer.at(3, 0) = 0, f.labels.at(3, 0) = kInSilhouette | 2;  // wrong: virtual missing
  f.layer.at(4, 0) = 1, f.labels.at(4, 0) = 0;  // wrong key, but nothing virtual here
  EXPECT_DOUBLE_EQ(*f.errors().order_wrong_pct, 50.0);
}

TEST(LightError, LeavesOutVirtualPixelsAndSplitsOffTheShadow) {
  Frame f({4, 1});
  f.light.at(0, 0) = 0.5F, f.true_light.at(0, 0) = 0.8F;
  f.light.at(1, 0) = 0.9F, f.true_light.at(1, 0) = 1.0F;
  f.light.at(2, 0) = 0.985F, f.true_light.at(2, 0) = 0.995F;  // neither in shadow
  f.light.at(3, 0) = 0.0F, f.labels.at(3, 0) = kTofSees | 2;
  const Errors e = f.errors();
  EXPECT_NEAR(*e.light_rmse, std::sqrt((0.09 + 0.01 + 0.0001) / 3), 1e-6);
  EXPECT_NEAR(*e.light_shadow_rmse, std::sqrt((0.09 + 0.01) / 2), 1e-6);
}

TEST(Contested, IsSilhouetteShadowAndTheBandOfThePeople) {
  Frame f({40, 3});
  f.labels.at(0, 0) = kTofSees | kInSilhouette;
  f.true_light.at(2, 0) = 0.979F;
  f.true_light.at(3, 0) = 0.981F;
  f.light.at(4, 0) = 0.5F;     // what the composite says does not decide
  f.matte.at(5, 0) = 255;      // nor does this
  for (int y = 0; y < 3; ++y)  // the border lies between 29 and 30: the band is 21..38
    for (int x = 30; x < 40; ++x) f.true_matte.at(x, y) = x == 30 ? 128 : 255;
  const Image<std::uint8_t> marks =
      contested({f.true_color, f.true_depth, f.true_matte, f.true_light, f.labels});
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool own = y == 0 && (x == 0 || x == 2);
      EXPECT_EQ(marks.at(x, y), own || (x >= 21 && x <= 38) ? 1 : 0) << x << ' ' << y;
    }
}

/// 200 pixels: a border of the people's band and 100 pixels that nobody could get wrong.
TEST(Contested, MeasuresAreOfThosePixelsAlone) {
  Frame f({200, 1});
  for (int x = 0; x < 8; ++x) f.true_matte.at(x, 0) = f.matte.at(x, 0) = 255;  // band: 0..15
  for (int x = 16; x < 20; ++x) f.labels.at(x, 0) = kTofSees | kInSilhouette;  // occluded
  f.matte.at(7, 0) = 0;                                                        // a person lost
  f.matte.at(100, 0) = 255;           // a person found where none is
  f.true_light.at(3, 0) = 0.5F;       // in the band already
  f.light.at(150, 0) = 0.7F;          // a shadow where none is
  f.color.at(17, 0) = {10, 20, 90};   // 60 in one channel
  f.color.at(180, 0) = {10, 50, 30};  // 30 in one channel
  const Errors e = f.errors();
  EXPECT_NEAR(*e.contested.pixels_pct, 10.0, 1e-9);
  EXPECT_NEAR(*e.key_iou, 7.0 / 9, 1e-9);
  EXPECT_NEAR(*e.contested.key_iou, 7.0 / 8, 1e-9);
  EXPECT_NEAR(*e.matte_mse, 2.0 / 200, 1e-9);
  EXPECT_NEAR(*e.contested.matte_mse, 1.0 / 20, 1e-9);
  EXPECT_NEAR(*e.light_rmse, std::sqrt((0.25 + 0.09) / 200), 1e-6);
  EXPECT_NEAR(*e.contested.light_rmse, std::sqrt(0.25 / 20), 1e-6);
  EXPECT_NEAR(*e.light_shadow_rmse, std::sqrt((0.25 + 0.09) / 2), 1e-6);
  EXPECT_NEAR(*e.color_psnr_db, 10 * std::log10(255.0 * 255.0 / (4500.0 / 600)), 1e-9);
  EXPECT_NEAR(*e.contested.color_psnr_db, 10 * std::log10(255.0 * 255.0 / (3600.0 / 60)), 1e-9);
}

TEST(Contested, WithoutAPixelMeasuresNothing) {
  const Errors e = Frame({4, 4}).errors();
  EXPECT_EQ(e.contested.pixels_pct, 0.0);
  EXPECT_EQ(e.contested.matte_mse, std::nullopt);
  EXPECT_EQ(e.contested.color_psnr_db, std::nullopt);
}

TEST(ObjectError, IsOfPixelsThatAreVirtualInBoth) {
  Frame f({4, 1});
  for (int x = 0; x < 3; ++x) f.labels.at(x, 0) = kInSilhouette | kLayerVirtual;
  for (int x : {0, 1, 3}) f.layer.at(x, 0) = kLayerVirtual;
  f.color.at(0, 0) = {255, 20, 30}, f.true_color.at(0, 0) = {0, 20, 30};  // 1 in linear light
  f.color.at(1, 0) = {188, 20, 30}, f.true_color.at(1, 0) = {0, 20, 30};  // 0.5029
  f.color.at(2, 0) = {200, 200, 200};                                     // missing
  f.color.at(3, 0) = {200, 200, 200};                                     // where none is
  const Errors e = f.errors();
  EXPECT_NEAR(*e.object_rmse, std::sqrt((1.0 + 0.50289 * 0.50289) / 6), 1e-5);
  EXPECT_NEAR(*e.object_psnr_db, 10 * std::log10(255.0 * 255.0 / ((255.0 * 255 + 188.0 * 188) / 6)),
              1e-9);
}

TEST(ColorPsnr, ComparesAllChannels) {
  Frame f({2, 1});
  f.color.at(0, 0) = {13, 16, 30};  // squares 9 + 16 over 6 values
  EXPECT_NEAR(*f.errors().color_psnr_db, 10 * std::log10(255.0 * 255.0 / (25.0 / 6.0)), 1e-9);
}

TEST(Errors, RefuseImagesOfAnotherSizeAndAddNothing) {
  Frame f({4, 4});
  f.light.reset({4, 3});
  ErrorSums sums;
  const auto result = f.add_to(sums);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kData);
  EXPECT_EQ(sums.depth_bad.count, 0U);
}

}  // namespace
}  // namespace mixrig::measure
