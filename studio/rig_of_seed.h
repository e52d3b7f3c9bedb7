// SPDX-License-Identifier: Apache-2.0
// The rig of a seed: a preset with manufacturing tolerances, and its pan-tilt unit. Takes and board
// views of the same preset, seed and tolerance show the same rig.
#pragma once

#include "studio/pan_tilt_unit.h"
#include "studio/rig.h"

namespace mixrig::studio {

struct Rig {
  Optics target;
  TofSensor tof;
  std::optional<TofSensor> tof2;
  FisheyeOptics fisheye;
  geometry::Pose target_from_fisheye;
  PanTiltUnit pan_tilt;
};

/// The rig of a seed. `tolerance` is a factor on the deviations of lenses and mounting, 0..2: with
/// 0 they are the preset's, with 1 focal lengths are within 1 % of it, mounting within 4 mm and 0.6
/// degrees (each axis). The pan-tilt unit differs from seed to seed whatever the tolerance. With
/// `second` it has a second depth camera; the other parts are the same as without.
Rig rig_of_seed(RigPreset preset, unsigned seed, Size target_px, double tolerance,
                std::optional<RigPreset> second = std::nullopt);

/// Systematic error of a distance that is measured without correction, metres.
double depth_error_m(const TofSensor& sensor, double distance_m);
/// Sets the systematic error's amplitude, metres, as it is measured without correction.
void set_depth_error(TofSensor& sensor, double most_m);

}  // namespace mixrig::studio
