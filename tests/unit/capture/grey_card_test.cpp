// SPDX-License-Identifier: Apache-2.0
// A grey card through known cameras: the standards' own curves from light to sample, black level,
// noise, rounding. The verdicts have to find what was put in.
#include "host/capture/capture/grey_card.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::capture {
namespace {

using device::Transfer;
using Kind = LinearVerdict::Kind;

/// Sample value of a light value, by the formula of each standard.
double sample_of_light(Transfer transfer, double gamma, double light) {
  switch (transfer) {
    case Transfer::kSrgb:
      return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    case Transfer::kBt709:
      return light < 0.018 ? 4.5 * light : 1.099 * std::pow(light, 0.45) - 0.099;
    case Transfer::kLinear:
      return light;
    case Transfer::kGamma:
      return std::pow(light, 1 / gamma);
  }
  return light;
}

struct Card {
  Transfer transfer = Transfer::kSrgb;
  double gamma = 1.6;
  double black = 0;  ///< of 255
  double noise = 1;  ///< of 255, standard deviation of a sample
  std::array<double, 3> tint{1, 1, 1};
  Size size{60, 40};
  bool words = false;  ///< bytes are cut from 16 bits

  CardSamples shown(double light, double exposure_s) const {
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0, noise);
    const auto byte = [&](double tinted) {
      const double sample = sample_of_light(transfer, gamma, std::min(tinted, 1.0));
      const double of_255 = black + (255 - black) * sample + normal(random);
      const double steps = words ? std::floor(of_255 / 255 * 65535 / 256) : std::round(of_255);
      return static_cast<std::uint8_t>(std::clamp(steps, 0.0, 255.0));
    };
    Image<Rgb8> plate({size.width + 4, size.height + 4}, Rgb8{255, 0, 255});
    for (int y = 2; y < size.height + 2; ++y)
      for (int x = 2; x < size.width + 2; ++x)
        plate.at(x, y) = {byte(light * tint[0]), byte(light * tint[1]), byte(light * tint[2])};
    CardSamples samples{exposure_s, words, {}};
    samples.add(plate.view(), {2, 2, size});
    return samples;
  }
  std::array<CardSamples, 4> exposed(double light) const {
    return {shown(light, 8e-3), shown(light / 2, 4e-3), shown(light / 4, 2e-3), shown(light, 8e-3)};
  }
};

ColorSettings declared(Transfer transfer, double black_of_255 = 0, double gamma = 2.2) {
  ColorSettings settings;
  settings.encoding.transfer = transfer;
  settings.encoding.gamma = gamma;
  settings.black = black_of_255 / 255;
  return settings;
}

constexpr std::array kAll{Transfer::kSrgb, Transfer::kBt709, Transfer::kLinear, Transfer::kGamma};

TEST(GreyCard, TheDeclaredTransferIsRight) {
  for (const Transfer transfer : kAll) {
    const auto verdict =
        judge_linear(Card{.transfer = transfer}.exposed(0.6), declared(transfer, 0, 1.6));
    EXPECT_EQ(verdict.kind, Kind::kRight) << static_cast<int>(transfer);
    EXPECT_NEAR(verdict.doublings[0], 2, 0.02);
    EXPECT_NEAR(verdict.doublings[1], 2, 0.02);
  }
}

TEST(GreyCard, AnotherTransferIsFound) {
  for (const Transfer truth : kAll)
    for (const Transfer wrong : {Transfer::kSrgb, Transfer::kBt709, Transfer::kLinear}) {
      if (truth == wrong) continue;
      for (const double light : {0.5, 0.85}) {
        const auto verdict = judge_linear(Card{.transfer = truth}.exposed(light), declared(wrong));
        ASSERT_EQ(verdict.kind, Kind::kOther) << static_cast<int>(truth);
        EXPECT_EQ(verdict.fit.encoding.transfer, truth);
        EXPECT_EQ(verdict.fit.black, 0);
        EXPECT_GT(std::abs(verdict.doublings[0] - 2), 0.05);
        EXPECT_TRUE(truth != Transfer::kGamma || std::abs(verdict.fit.encoding.gamma - 1.6) < 0.05)
            << verdict.fit.encoding.gamma;
      }
    }
}

TEST(GreyCard, ABlackLevelThatIsNotDeclaredIsFound) {
  for (const double black : {12.0, 40.0}) {
    const auto samples = Card{.transfer = Transfer::kLinear, .black = black}.exposed(0.8);
    const auto verdict = judge_linear(samples, declared(Transfer::kLinear));
    ASSERT_EQ(verdict.kind, Kind::kOther);
    EXPECT_EQ(verdict.fit.encoding.transfer, Transfer::kLinear);
    EXPECT_NEAR(255 * verdict.fit.black, black, 1.5);
    EXPECT_EQ(judge_linear(samples, declared(Transfer::kLinear, black)).kind, Kind::kRight);
  }
  const auto none = Card{.transfer = Transfer::kLinear}.exposed(0.8);
  const auto verdict = judge_linear(none, declared(Transfer::kLinear, 16));
  ASSERT_EQ(verdict.kind, Kind::kOther) << "a black level that is declared and not there";
  EXPECT_NEAR(255 * verdict.fit.black, 0, 1.5);
}

TEST(GreyCard, NoiseDoesNotChangeTheVerdict) {
  const Card card{.transfer = Transfer::kLinear, .noise = 8};
  EXPECT_EQ(judge_linear(card.exposed(0.7), declared(Transfer::kLinear)).kind, Kind::kRight);
  const auto verdict = judge_linear(card.exposed(0.7), declared(Transfer::kSrgb));
  EXPECT_EQ(verdict.kind, Kind::kOther);
  EXPECT_EQ(verdict.fit.encoding.transfer, Transfer::kLinear);
}

TEST(GreyCard, ExposuresThatAreNoStopApartAreTakenAsTheyAre) {
  const Card card{.transfer = Transfer::kLinear};
  const std::array<CardSamples, 4> exposures{card.shown(0.8, 8e-3), card.shown(0.45, 4.5e-3),
                                             card.shown(0.25, 2.5e-3), card.shown(0.8, 8e-3)};
  const auto verdict = judge_linear(exposures, declared(Transfer::kLinear));
  EXPECT_EQ(verdict.kind, Kind::kRight);
  EXPECT_NEAR(verdict.doublings[0], 2, 0.02);
}

TEST(GreyCard, WhatIsNotTheCamerasCurveIsTold) {
  const Card card;
  const ColorSettings settings = declared(Transfer::kSrgb);
  auto exposures = card.exposed(0.6);
  exposures[3] = card.shown(0.57, 8e-3);
  EXPECT_EQ(judge_linear(exposures, settings).kind, Kind::kUnsteady);
  exposures = {card.shown(0.6, 8e-3), card.shown(0.6, 4e-3), card.shown(0.6, 2e-3),
               card.shown(0.6, 8e-3)};
  EXPECT_EQ(judge_linear(exposures, settings).kind, Kind::kNoEffect);
  exposures[1] = card.shown(0.5, 4e-3);  // an automatic control works against it, then not
  exposures[2] = card.shown(0.1, 2e-3);
  const auto verdict = judge_linear(exposures, settings);
  EXPECT_EQ(verdict.kind, Kind::kNoneFits);
  EXPECT_EQ(verdict.fit.encoding, settings.encoding);
}

TEST(GreyCard, ATintIsTakenAwayByItsGains) {
  const Card card{.transfer = Transfer::kLinear, .tint = {0.5, 1, 0.8}};
  const CardSamples samples = card.shown(0.7, 8e-3);
  ColorSettings settings = declared(Transfer::kLinear);
  GreyVerdict verdict = judge_grey(samples, settings);
  EXPECT_FALSE(verdict.grey);
  EXPECT_NEAR(verdict.red_green, 0.5, 0.01);
  EXPECT_NEAR(verdict.blue_green, 0.8, 0.01);
  EXPECT_NEAR(verdict.gains[0], 2, 0.02);
  EXPECT_EQ(verdict.gains[1], 1);
  EXPECT_NEAR(verdict.gains[2], 1.25, 0.02);
  settings.gains = verdict.gains;
  verdict = judge_grey(samples, settings);
  EXPECT_TRUE(verdict.grey);
  EXPECT_NEAR(verdict.gains[0], 2, 0.02) << "the same again";
}

TEST(GreyCard, TheGainsAreThoseOfLinearLight) {
  const Card card{.tint = {1, 0.8, 0.5}};
  const GreyVerdict verdict = judge_grey(card.shown(0.7, 8e-3), declared(Transfer::kSrgb));
  EXPECT_NEAR(verdict.red_green, 1.25, 0.01);
  EXPECT_NEAR(verdict.gains[2], 2, 0.03);
}

TEST(GreyCard, ACardThatCannotBeJudgedIsSaidToBe) {
  const ColorSettings settings = declared(Transfer::kSrgb);
  EXPECT_EQ(card_state(Card().shown(0.5, 8e-3), settings), CardState::kGood);
  EXPECT_EQ(card_state(Card().shown(0.99, 8e-3), settings), CardState::kSaturated);
  const Card red{.tint = {1.7, 1, 1}};
  EXPECT_EQ(card_state(red.shown(0.6, 8e-3), settings), CardState::kSaturated) << "one channel";
  EXPECT_EQ(card_state(Card().shown(0.006, 8e-3), settings), CardState::kDark);
  const Card pedestal{.transfer = Transfer::kLinear, .black = 20};
  EXPECT_EQ(card_state(pedestal.shown(0.05, 8e-3), declared(Transfer::kLinear, 20)),
            CardState::kDark);
  const Card small{.noise = 10, .size = {4, 4}};
  EXPECT_EQ(card_state(small.shown(0.5, 8e-3), settings), CardState::kTooNoisy);
  CardSamples two = Card().shown(0.7, 8e-3);
  const CardSamples darker = Card().shown(0.2, 8e-3);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < 256; ++i) two.counts[c][i] += darker.counts[c][i];
  EXPECT_EQ(card_state(two, settings), CardState::kUneven);
}

TEST(GreyCard, BytesThatAreCutFromWordsAreNotTooLow) {
  const Card card{.transfer = Transfer::kLinear, .words = true};
  const ColorSettings settings = declared(Transfer::kLinear);
  EXPECT_NEAR(mean_light(card.shown(0.2, 8e-3), settings)[1], 0.2, 4e-4);
  EXPECT_EQ(judge_linear(card.exposed(0.45), settings).kind, Kind::kRight);
}

TEST(GreyCard, ADecoderOfRawSettingsLeavesTheSamples) {
  ColorSettings settings = declared(Transfer::kLinear, 16);
  settings.gains = {2, 1, 1.5};
  const std::array<std::uint8_t, 3> pixel{40, 80, 120};
  const device::Frame frame{
      .format = device::PixelFormat::kRgb8, .size = {1, 1}, .stride_bytes = 3, .bytes = pixel};
  Image<Rgb8> plate;
  ASSERT_TRUE(ColorDecoder(raw_settings(settings)).decode(frame, plate));
  EXPECT_EQ(plate.at(0, 0), (Rgb8{40, 80, 120}));
}

}  // namespace
}  // namespace mixrig::capture
