// SPDX-License-Identifier: Apache-2.0
// How bright lamps are, from pictures of one view at several exposures (Debevec and Malik 1997,
// with a known curve of tones).
#pragma once

#include <functional>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "host/room/lamps/bright_regions.h"

namespace mixrig::lights {

/// One of the pictures: sRGB, from the same place.
struct BracketShot {
  ImageView<const Rgb8> picture;
  double exposure = 1;  ///< relative: with twice as much a pixel has twice the light
};

struct BracketLight {
  Image<float> luminance;         ///< linear, 1: white at an exposure of 1
  Image<std::uint8_t> saturated;  ///< 1: even in the shortest shot, so that it is at least that
};

/// Each pixel has its light in the longest shot in which no channel is saturated
/// (RegionOptions::saturation). Channels
/// saturate alone, so a coloured lamp needs a shot in which none does. Precondition: shots of one
/// size with exposures above 0; of none the pictures are empty. Pure.
BracketLight light_of_bracket(std::span<const BracketShot> shots);

/// Pixel of a direction in the axes of a region's rays; nullopt outside the picture.
using PixelOfRay = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector3d& ray)>;

struct RegionLight {
  double radiance = 0;         ///< mean over the region's solid angle, unit of BracketLight
  double saturated_share = 0;  ///< of its rays: what is too bright for all shots
};

/// Of a region of a picture from the same place, by its rays. Rays that fall outside the picture do
/// not count; without any, all is 0.
RegionLight light_of_region(const BracketLight& light, const BrightRegion& region,
                            const PixelOfRay& pixel);

}  // namespace mixrig::lights
