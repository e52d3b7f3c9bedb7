// SPDX-License-Identifier: Apache-2.0
// The rigs: lenses, mounting and sensors of the presets.
#pragma once

#include "host/studio/studio.h"

namespace mixrig::studio {

/// A time-of-flight camera by phase. Charges in electrons of one tap.
struct TofSensor {
  Optics optics;
  geometry::Pose target_from_tof;
  double fine_hz = 20e6;
  double coarse_hz = 0;      ///< second frequency that resolves ambiguity; 0 for none
  double exposure_s = 0.02;  ///< all four taps, one after another
  float signal_e = 0;        ///< from albedo 1 at 1 m, facing
  float contrast = 0.9F;     ///< of the modulation
  float background_e = 0;    ///< room light on albedo 1
  float read_noise_e = 0;
  float full_well_e = 0;        ///< a tap beyond it makes the pixel unknown
  float least_amplitude_e = 0;  ///< below it a pixel is unknown
  float wiggle_rad = 0;         ///< systematic phase error, sin of four times the phase
  float wiggle_left = 0.12F;    ///< share that the factory's correction leaves
  double unit_m = 0.001;
  DepthNoise noise;  ///< measured, tests/unit/studio holds it
};

TofSensor tof_sensor(RigPreset rig);
/// Target camera of a rig: as wide as the depth camera beside it can follow.
Optics target_optics(RigPreset rig, Size size_px);
/// The camera below the others, 185 degrees.
FisheyeInfo fisheye_camera();
/// The same camera without distortion.
Optics without_distortion(Optics optics);

}  // namespace mixrig::studio
