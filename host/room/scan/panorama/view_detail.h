// SPDX-License-Identifier: Apache-2.0
// Brightness of a plate without its local mean, at a coarser size. Gains, vignetting and light that
// changes slowly over the picture do not affect it. Private to this module.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::model {

/// Mean of the channels in sRGB bytes over squares of `factor` pixels, minus its mean over 5 by 5
/// of these squares. Pixels at the right and lower border that do not fill a square are left out.
Image<float> detail_of(ImageView<const Rgb8> plate, int factor);

struct Detail {
  double value = 0;
  Eigen::Vector2d gradient;  ///< per pixel of `detail`
};
/// Bilinear value at a pixel of the plate; nullopt within two pixels of the border of `detail`.
std::optional<Detail> detail_at(const Image<float>& detail, const Eigen::Vector2d& plate_px,
                                int factor);

}  // namespace mixrig::model
