// SPDX-License-Identifier: Apache-2.0
// The fisheye picture: light along one ray a pixel and sample, then noise; lamps saturate.
#pragma once

#include "studio/sensors/noise.h"
#include "studio/sensors/picture.h"

namespace mixrig::studio {

/// Position of a ray within its pixel, and its share of the light of the exposure.
struct FisheyeSample {
  double x_px = 0, y_px = 0;  ///< from the pixel's centre
  float share = 1;
};

/// Adds a sample of the linear light to `sum`, which has the camera's size; nothing outside the
/// image circle.
void add_fisheye_light(const FisheyeOptics& camera, const FisheyeSample& sample,
                       const geometry::Pose& world_from_fisheye, const TraceScene& room,
                       const ShadowCasters& casters, const Materials& materials,
                       const LampSet& lamps, const Light& light, Crew& crew, Image<Rgbf>& sum,
                       double& people_share);

/// Photon and read noise, then sRGB; black outside the image circle. The noise depends on `key`.
void develop_fisheye(const FisheyeOptics& camera, const Image<Rgbf>& light, std::uint64_t key,
                     const NormalTable& normal, Crew& crew, Image<Rgb8>& picture);

}  // namespace mixrig::studio
