// SPDX-License-Identifier: Apache-2.0
// Regions of a picture that may be lamps: saturated in all channels.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::lights {

/// Unit direction of a pixel in any axes; nullopt where the picture shows nothing.
using RayOfPixel = std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector2d& px)>;

struct RegionOptions {
  int saturation = 250;      ///< least value of each channel of a seed, 1..255
  int least_pixels = 6;      ///< of a region
  std::size_t most = 64;     ///< regions, the largest first
  bool goes_around = false;  ///< the picture's columns go around: a panorama
};

/// A pixel of a region.
struct RegionRay {
  Eigen::Vector3d direction;  ///< unit, axes of the rays
  double solid_angle_sr = 0;
};

struct BrightRegion {
  Eigen::Vector3d direction;   ///< of the centre of gravity of its solid angle, unit
  Eigen::Matrix3d covariance;  ///< of direction, rad^2; its rank is 2
  double solid_angle_sr = 0;
  Eigen::Vector2d centre_px;  ///< mean of its pixels
  int pixels = 0;
  double surround = 0;          ///< linear light around it over that inside, upper quartile
  bool cut = false;             ///< by the border of the picture or of what the lens shows
  std::vector<RegionRay> rays;  ///< of its pixels, at most kMostRegionRays, evenly chosen
};
inline constexpr int kMostRegionRays = 1024;

/// Seeds are pixels of at least `saturation` in all channels. A region grows from its seeds to
/// neighbours within the 99 % interval of the seeds' least channel (Frahm, Koeser, Grest and Koch
/// 2005, section 7), whose sigma is at least two grey levels. `surround` is that of pixels three to
/// five away; that of a region amid saturated ones is 1. The covariance says that each pixel of the
/// border is covered by an unknown share. Pure and bounded: time and memory grow with the pixels of
/// the picture. Regions in order of their solid angle, the largest first.
std::vector<BrightRegion> find_bright_regions(ImageView<const Rgb8> picture, const RayOfPixel& ray,
                                              const RegionOptions& options = {});

}  // namespace mixrig::lights
