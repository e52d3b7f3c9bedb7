// SPDX-License-Identifier: Apache-2.0
// Aligns all sightings of a track to their common appearance. Private to this module.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::reconstruction {

/// A sighting, and how the picture there is distorted relative to the reference picture.
struct TrackLook {
  const Image<std::uint8_t>* grey = nullptr;  ///< the picture, smoothed
  Eigen::Vector2d px;                         ///< in and out
  Eigen::Matrix2d from_reference;             ///< pixels here per pixel in the reference
  double sigma_px = 0;                        ///< out: 0 where it does not look like the others
};

/// Smooths by a Gaussian of 0.8 px, so that edges without antialiasing do not jump from pixel to
/// pixel.
Image<std::uint8_t> smoothed(ImageView<const std::uint8_t> grey);

/// Aligns windows of 15 x 15 px to that of `reference`, then to the mean of all, by inverse
/// compositional Lucas-Kanade (Baker and Matthews 2004) in shift, gain and offset. An error of the
/// mean shifts all sightings alike, so unlike tracking from picture to picture, no error
/// accumulates along the track. False, with nothing changed, where `reference` has no window or
/// fewer than two sightings agree.
bool align_looks(std::span<TrackLook> looks, std::size_t reference);

}  // namespace mixrig::reconstruction
