// SPDX-License-Identifier: Apache-2.0
// Measures how bright lamps are, from pictures of one view at several exposures (Debevec and Malik
// 1997, with a known tone curve).
#pragma once

#include <functional>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/room/lamps/bright_regions.h"

namespace mixrig::lights {

/// One picture of a bracket, sRGB; all are taken from the same place.
struct BracketShot {
  ImageView<const Rgb8> picture;
  double exposure = 1;  ///< relative: twice the value means twice the light in a pixel
};

struct BracketLight {
  Image<float> luminance;  ///< linear; 1: white at an exposure of 1
  /// 1: saturated even in the shortest shot; luminance is a lower limit.
  Image<std::uint8_t> saturated;
};

/// Combines the shots: each pixel takes its light from the longest shot in which no channel is
/// saturated (RegionOptions::saturation). Channels saturate separately, so a coloured lamp needs a
/// shot in which none does. Precondition: shots of one size with exposures above 0. Without shots
/// the pictures are empty. Pure.
BracketLight light_of_bracket(std::span<const BracketShot> shots);

/// Maps a direction, in the axes of a region's rays, to a pixel; nullopt outside the picture.
using PixelOfRay = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector3d& ray)>;

struct RegionLight {
  double radiance = 0;         ///< mean over the region's solid angle, unit of BracketLight
  double saturated_share = 0;  ///< share of its rays that are too bright for all shots
};

/// Light of a region, by its rays, in a bracket taken from the same place. Rays outside the picture
/// are ignored; without any ray inside, all is 0.
RegionLight light_of_region(const BracketLight& light, const BrightRegion& region,
                            const PixelOfRay& pixel);

}  // namespace mixrig::lights
