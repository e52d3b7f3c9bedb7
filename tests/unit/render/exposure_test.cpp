// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/exposure.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::render {
namespace {

constexpr Size kExposureSize{128, 96};

std::uint8_t srgb(float linear) {
  const double v = std::min(1.0F, linear);
  return static_cast<std::uint8_t>(
      std::lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055)));
}

/// A room of grey shades that all sensors see, learned at gain 1.
struct Room {
  Image<Rgbf> learned{kExposureSize};
  Tables tables;
  Room() {
    tables.view_size = tables.plate_size = kExposureSize;
    tables.plate_is_view = true;
    for (int y = 0; y < kExposureSize.height; ++y)
      for (int x = 0; x < kExposureSize.width; ++x) {
        const float v = 0.05F + 0.3F * static_cast<float>((x * 7 + y * 3) % 50) / 50;
        learned.at(x, y) = {v, 0.9F * v, 0.8F * v};
      }
  }
  Image<Rgb8> plate(const glm::vec3& gain) const {
    Image<Rgb8> out(kExposureSize);
    for (int y = 0; y < kExposureSize.height; ++y)
      for (int x = 0; x < kExposureSize.width; ++x) {
        const Rgbf b = learned.at(x, y);
        out.at(x, y) = {srgb(gain.r * b.r), srgb(gain.g * b.g), srgb(gain.b * b.b)};
      }
    return out;
  }
  BackgroundView background() const { return {{}, {}, learned.view(), {}}; }
};

TEST(ExposureMeter, FindsTheGainOfEachChannel) {
  const Room room;
  ExposureMeter meter(room.tables, room.background());
  for (const glm::vec3 wanted : {glm::vec3(1), glm::vec3(1.4F, 1.3F, 1.2F), glm::vec3(0.5F)}) {
    const glm::vec3 gain = meter.gain(room.plate(wanted));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(gain[c], wanted[c], 0.01F * wanted[c]);
  }
}

TEST(ExposureMeter, ComparesThePlateWithoutItsVignetting) {
  Room room;
  room.tables.plate_gain.reset(kExposureSize, 1.6F);
  ExposureMeter meter(room.tables, room.background());
  EXPECT_NEAR(meter.gain(room.plate(glm::vec3(1.0F / 1.6F))).g, 1, 0.01);
}

TEST(ExposureMeter, PeopleInHalfOfThePictureDoNotMoveIt) {
  const Room room;
  ExposureMeter meter(room.tables, room.background());
  Image<Rgb8> plate = room.plate(glm::vec3(1.5F));
  for (int y = 0; y < kExposureSize.height; ++y)
    for (int x = 0; x < kExposureSize.width / 2; ++x) {
      const auto shade = static_cast<std::uint8_t>(40 + (x * 13 + y * 29) % 160);
      plate.at(x, y) = {shade, static_cast<std::uint8_t>(shade / 2), shade};
    }
  EXPECT_NEAR(meter.gain(plate).g, 1.5F, 0.03F);
}

/// A camera that compresses bright light, learned at one gain and seen at another; people in a
/// third of the picture.
TEST(ExposureMeter, FindsTheCurveOfACameraThatCompressesBrightLight) {
  const auto shown = [](float light) { return 1.6F * light / (light + 0.6F); };
  Room room;
  Image<Rgb8> plate(kExposureSize);
  for (int y = 0; y < kExposureSize.height; ++y)
    for (int x = 0; x < kExposureSize.width; ++x) {
      const float light = 0.01F * std::exp(0.075F * static_cast<float>((x * 7 + y * 3) % 60));
      const float then = shown(light), now = shown(1.8F * light);
      room.learned.at(x, y) = {then, then, then};
      plate.at(x, y) = {srgb(now), srgb(now), srgb(now)};
      if (x < kExposureSize.width / 3) plate.at(x, y) = {30, static_cast<std::uint8_t>(20 + y), 60};
    }
  ExposureMeter meter(room.tables, room.background());
  const ToneCurve curve = meter.curve(plate);
  ASSERT_TRUE(curve.bends);
  double worst = 0, worst_by_gain = 0;
  for (float then = 0.03F; then < 0.85F; then *= 1.1F) {
    const float light = 0.6F * then / (1.6F - then), now = std::min(1.0F, shown(1.8F * light));
    const glm::vec3 told = glm::min(curve(glm::vec3(then)), 1.0F);
    worst = std::max<double>(worst, std::abs(told.g / now - 1));
    worst_by_gain =
        std::max<double>(worst_by_gain, std::abs(std::min(1.0F, curve.gain.g * then) / now - 1));
  }
  EXPECT_LT(worst, 0.09);
  EXPECT_GT(worst_by_gain, 0.2) << "a gain alone does not tell it";
}

TEST(ExposureMeter, ACurveOfAGainAloneIsStraight) {
  const Room room;
  ExposureMeter meter(room.tables, room.background());
  const ToneCurve curve = meter.curve(room.plate(glm::vec3(1.4F, 1.3F, 1.2F)));
  EXPECT_FALSE(curve.bends);
  EXPECT_NEAR(curve(glm::vec3(0.2F)).r, 0.28F, 0.003F);
}

/// Whoever hides all bright places is no curve of the camera.
TEST(ExposureMeter, PeopleBendNothingWhileTheExposureStays) {
  const Room room;
  ExposureMeter meter(room.tables, room.background());
  Image<Rgb8> plate = room.plate(glm::vec3(1));
  for (int y = 0; y < kExposureSize.height; ++y)
    for (int x = 0; x < kExposureSize.width; ++x)
      if (room.learned.at(x, y).g > 0.2F) plate.at(x, y) = {60, 70, 80};
  EXPECT_FALSE(meter.curve(plate).bends);
}

TEST(ExposureMeter, SaysOneWhereNothingCanTell) {
  const Room room;
  ExposureMeter meter(room.tables, room.background());
  EXPECT_EQ(meter.gain(Image<Rgb8>(kExposureSize, Rgb8{255, 255, 255})),
            glm::vec3(1));                                          // saturated
  EXPECT_EQ(meter.gain(Image<Rgb8>(kExposureSize)), glm::vec3(1));  // black
  ExposureMeter unlearned(room.tables, {});
  EXPECT_EQ(unlearned.gain(room.plate(glm::vec3(2))), glm::vec3(1));
}

}  // namespace
}  // namespace mixrig::render
