// SPDX-License-Identifier: Apache-2.0
// Brightness of a plate without its local mean, at a coarser size: gains, vignetting and light that
// changes slowly over the picture do not reach it. Private to this module.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::model {

/// Mean of the channels in bytes of sRGB, over squares of `factor` pixels, minus its mean over 5 by
/// 5 of those. Pixels at the right and lower border that fill no square are left out.
Image<float> detail_of(ImageView<const Rgb8> plate, int factor);

struct Detail {
  double value = 0;
  Eigen::Vector2d gradient;  ///< per pixel of `detail`
};
/// Bilinear at a pixel of the plate; none within two pixels of the border of `detail`.
std::optional<Detail> detail_at(const Image<float>& detail, const Eigen::Vector2d& plate_px,
                                int factor);

}  // namespace mixrig::model
