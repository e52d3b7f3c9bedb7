// SPDX-License-Identifier: Apache-2.0
// Finds regions of a picture that may be lamps: saturated in all channels.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::lights {

/// Maps a pixel to a unit direction, in any axes; nullopt where the picture shows nothing.
using RayOfPixel = std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d& px)>;

struct RegionOptions {
  int saturation = 250;      ///< least value of each channel of a seed, 1..255
  int least_pixels = 6;      ///< least size of a region
  std::size_t most = 64;     ///< most regions, the largest first
  bool goes_around = false;  ///< columns wrap around: a panorama
};

/// A pixel of a region.
struct RegionRay {
  Eigen::Vector3d direction;  ///< unit, in axes of RayOfPixel
  double solid_angle_sr = 0;
};

struct BrightRegion {
  Eigen::Vector3d direction;   ///< centre of gravity of the solid angle, unit
  Eigen::Matrix3d covariance;  ///< of direction, rad^2, rank 2
  double solid_angle_sr = 0;
  Eigen::Vector2d centre_px;  ///< mean of its pixels
  int pixels = 0;
  double surround = 0;          ///< linear light around it over that inside, upper quartile
  bool cut = false;             ///< cut by the border of the picture or of the lens's image
  std::vector<RegionRay> rays;  ///< rays of its pixels, at most kMostRegionRays, evenly chosen
};
inline constexpr int kMostRegionRays = 1024;

/// Finds bright regions, the largest solid angle first. Seeds are pixels of at least `saturation`
/// in all channels; a region grows from its seeds to neighbours within the 99 % interval of the
/// seeds' least channel (Frahm, Koeser, Grest and Koch 2005, section 7), whose sigma is at least
/// two grey levels. `surround` is taken from pixels three to five away, and is 1 amid saturated
/// ones. The covariance assumes that border pixels are covered by an unknown share. Pure; time and
/// memory grow with the pixels of the picture.
std::vector<BrightRegion> find_bright_regions(ImageView<const Rgb8> picture, const RayOfPixel& ray,
                                              const RegionOptions& options = {});

}  // namespace mixrig::lights
