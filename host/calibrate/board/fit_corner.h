// SPDX-License-Identifier: Apache-2.0
// Sub-pixel position of a corner where two black and two white squares meet.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::calibration {

/// Least-squares fit of the blurred corner itself to the pixels about it:
///   I(p) = (1 + a . d) (o + g erf(n1 . d / (sqrt(2) s)) erf(n2 . d / (sqrt(2) s))),  d = p -
///   corner,
/// with edge normals n1, n2, blur s and shading a. The model is even about the corner except for
/// the shading, so neither blooming nor tone curves move it; and it uses all pixels of the window,
/// where gradient methods use the edges alone.
struct CornerFit {
  Eigen::Vector2d px;
  double blur_px = 0;   ///< s: a standard deviation, the pixel's own area (0.29) included
  double contrast = 0;  ///< 2 |g|: grey levels between black and white
  double residual = 0;  ///< root mean square of the fit, as a share of the contrast
  double sigma_px = 0;  ///< standard deviation along the worse direction, from the residuals
};

/// `edge_a`, `edge_b`: directions of the two edges in the picture (any length), within some 20
/// degrees of the true ones. `start_px`: within less than half of `radius_px` of the corner.
/// nullopt where there is no such corner: out of the picture, no contrast, no convergence within
/// half the radius, poor fit.
std::optional<CornerFit> fit_corner(ImageView<const std::uint8_t> image,
                                    const Eigen::Vector2d& start_px, const Eigen::Vector2d& edge_a,
                                    const Eigen::Vector2d& edge_b, double radius_px);

}  // namespace mixrig::calibration
