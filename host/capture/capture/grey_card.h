// SPDX-License-Identifier: Apache-2.0
// What pictures of a grey card at several exposures tell of a camera's transfer, black level and
// white balance.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "hal/base/image.h"
#include "host/capture/capture/decode.h"

namespace mixrig::capture {

/// Pixels [x, x + size.width) by [y, y + size.height).
struct CardArea {
  int x = 0, y = 0;
  Size size{};
};

/// R'G'B' samples of a card at one exposure, before black level, transfer and gains.
struct CardSamples {
  double exposure_s = 0;
  bool cut = false;  ///< bytes are the upper ones of 16 bits: a sample is half a step more
  std::array<std::array<std::uint32_t, 256>, 3> counts{};  ///< of red, green, blue by byte

  /// Adds the pixels of a plate that a ColorDecoder of raw_settings() made. Precondition: `area`
  /// lies in the plate.
  void add(ImageView<const Rgb8> plate, const CardArea& area);
  double mean_byte(std::size_t color) const;
  double saturated_share() const;  ///< of the channel that saturates most
};

/// Settings of a decoder whose bytes are samples.
ColorSettings raw_settings(const ColorSettings& settings);

/// Mean linear light of red, green and blue without gains, in the settings' black level and
/// transfer.
std::array<double, 3> mean_light(const CardSamples& samples, const ColorSettings& settings);

enum class CardState {
  kGood,
  kSaturated,  ///< more than 1 % of a channel is at 250 of 255 or above
  kDark,       ///< the mean of a channel is less than 24 of 255 above black
  kUneven,     ///< the light of its pixels spreads by more than 30 %: not one card, or noise
  kTooNoisy,   ///< the mean light is not known within 0.5 %
};
/// The first that holds. Precondition: there are samples.
CardState card_state(const CardSamples& samples, const ColorSettings& settings);

struct GreyVerdict {
  bool grey = false;                     ///< both within 3 % of 1
  double red_green = 1, blue_green = 1;  ///< linear light, with the gains in use
  std::array<double, 3> gains{1, 1, 1};  ///< that make it grey; the least is 1
};
/// Precondition: card_state is kGood.
GreyVerdict judge_grey(const CardSamples& samples, const ColorSettings& settings);

struct LinearVerdict {
  enum class Kind {
    kRight,     ///< as declared
    kOther,     ///< `fit` explains the samples instead
    kNoneFits,  ///< nothing does: an automatic control, or tone mapping
    kUnsteady,  ///< the last exposure is not as bright as the first, the same one
    kNoEffect,  ///< the samples hardly differ
  } kind = Kind::kRight;
  std::array<double, 2> doublings{};  ///< light where the exposure doubles, as declared; 2 is right
  ColorSettings fit;                  ///< transfer, gamma and black level; else as declared
  double error = 0;                   ///< of the fit: largest log of light over exposure
};
/// Judges exposures of one card: one, about half, about a quarter of it, and the first again. Light
/// is proportional to exposure by the right black level and transfer: within 3 % from each exposure
/// to the next in each channel. Tried in this order: what is declared; sRGB, BT.709 and linear with
/// the declared black level; these with another black level (up to a quarter of full scale), or a
/// gamma of 0.5 to 4 with the declared one, whichever is nearest. Precondition: card_state of each
/// is kGood.
LinearVerdict judge_linear(std::span<const CardSamples, 4> exposures,
                           const ColorSettings& settings);

}  // namespace mixrig::capture
