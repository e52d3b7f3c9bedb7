// SPDX-License-Identifier: Apache-2.0
// Sightings of a smooth pattern, by formula, with noise: they come to rest where the pattern is.
#include "extras/map/reconstruction/features/track_align.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig {
namespace {

constexpr int kLooks = 12;

/// The pattern turned by `turn_rad` about `at`, with gain, offset and noise of 2 grey values.
Image<std::uint8_t> pattern(const Eigen::Vector2d& at, double turn_rad, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 2);
  const Eigen::Rotation2Dd back(-turn_rad);
  Image<std::uint8_t> picture({64, 48});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const Eigen::Vector2d p = back * (Eigen::Vector2d(x, y) - at);
      const double value = 40 * std::sin(0.5 * p.x()) * std::cos(0.37 * p.y()) +
                           20 * std::sin(0.3 * p.x() + 0.6 * p.y());
      const double gain = 1 - 0.02 * seed;
      picture.at(x, y) =
          static_cast<std::uint8_t>(std::lround(120 + 2 * seed + gain * value + noise(random)));
    }
  return picture;
}

Eigen::Vector2d true_px(int i) { return {30 + 0.13 * i, 24 - 0.21 * i}; }
double turn_rad(int i) { return 0.03 * i; }

struct Sequence {
  std::vector<Image<std::uint8_t>> pictures;
  std::vector<reconstruction::TrackLook> looks;

  Sequence() {
    for (int i = 0; i < kLooks; ++i)
      pictures.push_back(reconstruction::smoothed(
          pattern(true_px(i), turn_rad(i), static_cast<unsigned>(i + 1)).view()));
    const int reference = kLooks / 2;
    for (int i = 0; i < kLooks; ++i) {
      const Eigen::Rotation2Dd turn(turn_rad(i) - turn_rad(reference));
      const Eigen::Vector2d off(0.4 * std::sin(2.0 * i), 0.4 * std::cos(3.0 * i));
      looks.push_back({&pictures[static_cast<std::size_t>(i)],
                       true_px(i) + (i == reference ? Eigen::Vector2d::Zero() : off),
                       turn.toRotationMatrix(), 0});
    }
  }
};

TEST(TrackAlign, SightingsComeToRestOnOnePlaceOfThePattern) {
  Sequence s;
  ASSERT_TRUE(reconstruction::align_looks(s.looks, kLooks / 2));
  // The place of the reference itself may move, and all others with it.
  for (int i = 0; i < kLooks; ++i) {
    const auto& look = s.looks[static_cast<std::size_t>(i)];
    const Eigen::Vector2d common =
        look.from_reference * (s.looks[kLooks / 2].px - true_px(kLooks / 2));
    EXPECT_LT((look.px - true_px(i) - common).norm(), 0.06) << i;
    EXPECT_GT(look.sigma_px, 0.005) << i;
    EXPECT_LT(look.sigma_px, 0.1) << i;
  }
}

TEST(TrackAlign, WhatLooksOtherwiseIsLeftOut) {
  Sequence s;
  Image<std::uint8_t> other({64, 48});
  std::mt19937 random(5);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) other.at(x, y) = static_cast<std::uint8_t>(random() % 256);
  s.looks[2].grey = &other;
  ASSERT_TRUE(reconstruction::align_looks(s.looks, kLooks / 2));
  EXPECT_EQ(s.looks[2].sigma_px, 0);
  EXPECT_GT(s.looks[3].sigma_px, 0);
}

TEST(TrackAlign, AWindowOutsideThePictureOrWithoutContrastAlignsNothing) {
  Sequence s;
  s.looks[kLooks / 2].px = {3, 3};
  const Eigen::Vector2d before = s.looks[0].px;
  EXPECT_FALSE(reconstruction::align_looks(s.looks, kLooks / 2));
  EXPECT_EQ(s.looks[0].px, before);
  Sequence grey;
  const Image<std::uint8_t> flat({64, 48}, 100);
  for (auto& look : grey.looks) look.grey = &flat;
  EXPECT_FALSE(reconstruction::align_looks(grey.looks, kLooks / 2));
}

}  // namespace
}  // namespace mixrig
