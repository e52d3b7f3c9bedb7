// SPDX-License-Identifier: Apache-2.0
// Measures how bright lamps are, from how the planes of a scanned room are lit.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/math/estimation/verdict.h"
#include "host/room/lamps/lamp_tracks.h"
#include "host/room/lamps/room_surfaces.h"

namespace mixrig::lights {

/// Light of a room in units of geometry::Light.
struct RoomLight {
  std::vector<Eigen::Vector3f> intensity;  ///< of each lamp, linear RGB
  Eigen::Vector3f ambient{0, 0, 0};
  std::vector<double> largest_share;  ///< of each lamp: its largest share of the light at any place
  double residual = 0;                ///< robust spread of measured over fitted light, as a share
  int samples = 0, planes = 0;
};

struct ShadingOptions {
  double exposure = 1;       ///< of the scene
  double mean_albedo = 0.5;  ///< assumed: the pictures do not separate it from the lamps' strength
  int most_samples = 4000;
};

/// Measures lamps by shading. Each large plane of the room (host/room/scan/shape/room_planes.h) has
/// one unknown albedo a channel, so light is what varies over it: measured = albedo (ambient + sum
/// over the lamps of intensity times mean cos cos / d^2 over the panel times visibility). Solved
/// alternately for the albedos and, by non-negative least squares, for the light; Tukey's weights
/// exclude pictures, furniture and texture. Visibility is by rays in the room. Channels are scaled
/// so that the lamps together are white. The covariance (lamps, then ambient) is of luminance
/// relative to the sum of the intensities. Degenerate with too few places, or if lamps light them
/// alike.
estimation::Estimate<RoomLight> measure_light(const RoomSurfaces& room,
                                              std::span<const FoundLamp> lamps,
                                              const ShadingOptions& options = {});

}  // namespace mixrig::lights
