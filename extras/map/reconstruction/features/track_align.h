// SPDX-License-Identifier: Apache-2.0
// All sightings of a track aligned to what they have in common. Private to this module.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::reconstruction {

/// A sighting, and how the picture there differs from the track's middle one.
struct TrackLook {
  const Image<std::uint8_t>* grey = nullptr;  ///< the picture, smoothed
  Eigen::Vector2d px;                         ///< in and out
  Eigen::Matrix2d from_reference;             ///< pixels here per pixel in the reference
  double sigma_px = 0;                        ///< out: 0 where it does not look like the others
};

/// By a Gaussian of 0.8 px: edges without antialiasing do not jump from pixel to pixel.
Image<std::uint8_t> smoothed(ImageView<const std::uint8_t> grey);

/// Windows of 15 x 15 px are aligned to that of `reference`, then to the mean of all, by inverse
/// compositional Lucas-Kanade (Baker and Matthews 2004) in shift, gain and offset. What is wrong
/// with the mean shifts the place itself, alike for all sightings: unlike following from picture to
/// picture, nothing adds up over the track. False, with nothing changed, where `reference` has no
/// window or fewer than two sightings agree.
bool align_looks(std::span<TrackLook> looks, std::size_t reference);

}  // namespace mixrig::reconstruction
