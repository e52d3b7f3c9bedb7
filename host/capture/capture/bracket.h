// SPDX-License-Identifier: Apache-2.0
// Plates of a view that stands still at other exposures than its frames': when they are worth
// taking, and by what factor two plates really differ.
#pragma once

#include <optional>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::capture {

/// A plate at another exposure.
struct BracketPlate {
  double exposure_s = 0;  ///< as the camera says
  double frames_s = 0;    ///< that of the view's frames
  Image<Rgb8> plate;
};

inline constexpr int kSaturatedByte = 250;  ///< of 255: from here on a channel counts as saturated
inline constexpr int kDarkByte = 12;        ///< up to here a channel has less than five bits
inline constexpr double kBracketStep = 4;   ///< from exposure to exposure
inline constexpr double kSaturatedShare =
    5e-4;                                   ///< of a plate's pixels, that is worth a shorter one
inline constexpr double kDarkShare = 0.05;  ///< that is worth a longer one

/// Exposures that a camera can be told, seconds.
struct ExposureLimits {
  double least_s = 0, most_s = 0, step_s = 0;  ///< step 0: any
};

/// The exposure a step below that of a plate, or as low as the limits go; nothing where less than
/// kSaturatedShare of the pixels has a saturated channel, or where the limits leave less than a
/// third of a step.
std::optional<double> shorter_exposure(ImageView<const Rgb8> plate, double exposure_s,
                                       const ExposureLimits& limits);
/// A step above, where at least kDarkShare of the pixels is dark in all channels.
std::optional<double> longer_exposure(ImageView<const Rgb8> plate, double exposure_s,
                                      const ExposureLimits& limits);

/// Adds log(light of b / light of a) of every `stride`-th pixel that neither shows saturated and
/// that one of them shows well, each channel for itself. Precondition: plates of one size.
void add_log_ratios(ImageView<const Rgb8> a, ImageView<const Rgb8> b, int stride,
                    std::vector<float>& to);

}  // namespace mixrig::capture
