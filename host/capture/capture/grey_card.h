// SPDX-License-Identifier: Apache-2.0
// Measures a camera's transfer, black level and white balance from pictures of a grey card at
// several exposures.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hal/base/image.h"
#include "host/capture/capture/decode.h"

namespace mixrig::capture {

/// Area of the card: pixels [x, x + size.width) by [y, y + size.height).
struct CardArea {
  int x = 0, y = 0;
  Size size{};
};

/// R'G'B' samples of a card at one exposure, before black level, transfer and gains.
struct CardSamples {
  double exposure_s = 0;
  bool cut = false;  ///< bytes are the upper ones of 16-bit samples: a sample is half a step more
  std::array<std::array<std::uint32_t, 256>, 3> counts{};  ///< histograms of red, green, blue

  /// Adds the pixels of a plate that a ColorDecoder of raw_settings() made. Precondition: `area`
  /// lies in the plate.
  void add(ImageView<const Rgb8> plate, const CardArea& area);
  double mean_byte(std::size_t color) const;
  double saturated_share() const;  ///< share of the channel that saturates most
};

/// Returns settings for a decoder whose output bytes are the raw samples.
ColorSettings raw_settings(const ColorSettings& settings);

/// Returns the mean linear light of red, green and blue, without gains, by the black level and
/// transfer of `settings`.
std::array<double, 3> mean_light(const CardSamples& samples, const ColorSettings& settings);

enum class CardState {
  kGood,
  kSaturated,  ///< more than 1 % of a channel is at 250 of 255 or above
  kDark,       ///< the mean of a channel is less than 24 of 255 above black
  kUneven,     ///< the light of its pixels spreads by more than 30 %: not one card, or noise
  kTooNoisy,   ///< the mean light is not known within 0.5 %
};
/// Returns the first defect in the order of CardState, else kGood. Precondition: there are samples.
CardState card_state(const CardSamples& samples, const ColorSettings& settings);

struct GreyVerdict {
  bool grey = false;                     ///< both ratios are within 3 % of 1
  double red_green = 1, blue_green = 1;  ///< linear light, with the gains in use
  std::array<double, 3> gains{1, 1, 1};  ///< gains that make it grey; the smallest is 1
};
/// Judges the white balance. Precondition: card_state() is kGood.
GreyVerdict judge_grey(const CardSamples& samples, const ColorSettings& settings);

struct LinearVerdict {
  enum class Kind {
    kRight,     ///< the declared settings are right
    kOther,     ///< `fit` explains the samples instead
    kNoneFits,  ///< no model explains the samples: automatic control or tone mapping
    kUnsteady,  ///< the last exposure is not as bright as the equal first one
    kNoEffect,  ///< the samples hardly differ
  } kind = Kind::kRight;
  /// Ratio of light where the exposure doubles, by the declared settings; 2 is right.
  std::array<double, 2> doublings{};
  ColorSettings fit;  ///< transfer, gamma and black level; else as declared
  double error = 0;   ///< largest log of light over exposure, of the fit
};
/// Judges four exposures of one card: one, about half, about a quarter of it, and the first again.
/// With the right black level and transfer, light is proportional to exposure: within 3 % from each
/// exposure to the next in each channel. It tries in this order: the declared settings; sRGB,
/// BT.709 and linear with the declared black level; these with another black level (up to a quarter
/// of full scale), or a gamma of 0.5 to 4 with the declared one, whichever is nearest.
/// Precondition: card_state of each is kGood.
LinearVerdict judge_linear(std::span<const CardSamples, 4> exposures,
                           const ColorSettings& settings);

}  // namespace mixrig::capture
