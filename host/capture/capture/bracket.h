// SPDX-License-Identifier: Apache-2.0
// Plates of a static view at exposures other than its frames': decides when they are worth taking,
// and measures the true ratio of two plates.
#pragma once

#include <optional>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::capture {

/// A plate at another exposure.
struct BracketPlate {
  double exposure_s = 0;  ///< as the camera reports it
  double frames_s = 0;    ///< exposure of the view's frames
  Image<Rgb8> plate;
};

inline constexpr int kSaturatedByte = 250;  ///< of 255; a channel at or above it is saturated
inline constexpr int kDarkByte = 12;        ///< up to this value a channel has less than five bits
inline constexpr double kBracketStep = 4;   ///< ratio of neighbouring exposures
/// Saturated share of a plate's pixels from which on a shorter exposure is taken.
inline constexpr double kSaturatedShare = 5e-4;
/// Dark share of the pixels from which on a longer exposure is taken.
inline constexpr double kDarkShare = 0.05;

/// Range of exposures that a camera accepts, seconds.
struct ExposureLimits {
  double least_s = 0, most_s = 0, step_s = 0;  ///< step 0: any
};

/// Returns an exposure kBracketStep times shorter than the plate's, within the limits. Empty where
/// less than kSaturatedShare of the pixels has a saturated channel, or where the limits leave less
/// than a third of a step.
std::optional<double> shorter_exposure(ImageView<const Rgb8> plate, double exposure_s,
                                       const ExposureLimits& limits);
/// Returns an exposure kBracketStep times longer, within the limits. Empty where less than
/// kDarkShare of the pixels is dark in all channels, or where the limits leave less than a third of
/// a step.
std::optional<double> longer_exposure(ImageView<const Rgb8> plate, double exposure_s,
                                      const ExposureLimits& limits);

/// Appends log(light of b / light of a) for each channel of every `stride`-th pixel that is
/// saturated in neither plate and well exposed in one. Precondition: plates of one size.
void add_log_ratios(ImageView<const Rgb8> a, ImageView<const Rgb8> b, int stride,
                    std::vector<float>& to);

}  // namespace mixrig::capture
