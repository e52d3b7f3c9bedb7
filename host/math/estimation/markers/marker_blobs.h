// SPDX-License-Identifier: Apache-2.0
// Finds the centres of bright markers in an infrared picture (Cortes Reina 2015, section 2.4.1).
#pragma once

#include <cstdint>
#include <vector>

#include "hal/base/image.h"
#include "host/math/estimation/verdict.h"

namespace mixrig::estimation {

struct BlobOptions {
  int threshold = 128;        ///< grey value above which a pixel belongs to a marker, 0..254
  int min_area_px = 4;        ///< smaller blobs are noise
  int max_area_px = 10000;    ///< larger ones are lamps
  double sigma_grey = 2.0;    ///< noise of a pixel, for the covariance
  double max_elongation = 2;  ///< long over short axis; beyond, two markers have merged
};

struct MarkerBlob {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  int area_px = 0;
  double peak = 0;  ///< greatest grey value; 255 means saturated, which biases the centre
};

/// Finds connected bright regions (8-neighbours), in scan order. A centre is the centre of mass,
/// weights being grey value minus threshold; its bias by radius and phase:
/// docs/results/estimation.md. Covariance 2x2 of the centre in px^2. A blob that is cut by the
/// border, too small, too large or too long is returned as degenerate, with the reason.
std::vector<Estimate<MarkerBlob>> find_marker_blobs(ImageView<const std::uint8_t> picture,
                                                    const BlobOptions& options = {});

}  // namespace mixrig::estimation
