// SPDX-License-Identifier: Apache-2.0
// How bright lamps are, from how the planes of a scanned room are lit.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/math/estimation/verdict.h"
#include "host/room/lamps/lamp_tracks.h"
#include "host/room/lamps/room_surfaces.h"

namespace mixrig::lights {

/// As geometry::Light says what a surface shows.
struct RoomLight {
  std::vector<Eigen::Vector3f> intensity;  ///< of each lamp, linear RGB
  Eigen::Vector3f ambient{0, 0, 0};
  std::vector<double> largest_share;  ///< of the light at a place, that each lamp gives anywhere
  double residual = 0;                ///< robust spread of measured over fitted light, share
  int samples = 0, planes = 0;
};

struct ShadingOptions {
  double exposure = 1;  ///< of the scene
  double mean_albedo =
      0.5;  ///< of the planes: the pictures do not tell it from the lamps' strength
  int most_samples = 4000;
};

/// On each large plane of the room (host/room/scan/shape/room_planes.h) the albedo is taken as one
/// unknown a channel, so light is what varies over it: measured = albedo (ambient + sum over the
/// lamps of intensity times mean cos cos / d^2 over the panel times visibility). Solved in turns
/// for the albedos and, by least squares that are not negative, for the light; Tukey's weights
/// leave out pictures, furniture and texture. Visibility by rays in the room. Channels are scaled
/// so that the lamps together are white. Covariance (lamps, then ambient; luminance, relative to
/// the sum of the intensities); degenerate: too few places, or lamps that light them alike.
estimation::Estimate<RoomLight> measure_light(const RoomSurfaces& room,
                                              std::span<const FoundLamp> lamps,
                                              const ShadingOptions& options = {});

/// Mean of cos(receiver) [cos(emitter)] / d^2 over a lamp's panel, 1/m^2, without what hides it.
double irradiance_of(const geometry::Lamp& lamp, const Eigen::Vector3d& position_m,
                     const Eigen::Vector3d& normal);

}  // namespace mixrig::lights
