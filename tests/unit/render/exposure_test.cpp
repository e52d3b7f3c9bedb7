// SPDX-License-Identifier: Apache-2.0
#include "host/render/exposure.h"

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
