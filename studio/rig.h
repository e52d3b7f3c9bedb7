// SPDX-License-Identifier: Apache-2.0
// The presets of the rigs: lenses, mounting and sensors as designed.
#pragma once

#include "studio/studio.h"

namespace mixrig::studio {

/// A phase-based time-of-flight camera. Charges are electrons in one tap.
struct TofSensor {
  Optics optics;
  geometry::Pose target_from_tof;
  double fine_hz = 20e6;
  double coarse_hz = 0;      ///< second frequency, resolves the ambiguity; 0 for none
  double third_hz = 0;       ///< of raw pictures (sensors/raw_pictures.h); 0 for none
  double light_x_m = 0;      ///< the light source is so far right of the lens
  double exposure_s = 0.02;  ///< all four taps, in sequence
  float signal_e = 0;        ///< from albedo 1 at 1 m, perpendicular to the ray
  float contrast = 0.9F;     ///< modulation contrast
  float background_e = 0;    ///< room light on albedo 1
  float read_noise_e = 0;
  float full_well_e = 0;        ///< a tap above it makes the pixel unknown
  float least_amplitude_e = 0;  ///< a pixel below it is unknown
  float wiggle_rad = 0;         ///< systematic phase error: amplitude of sin(4 phase + 0.7)
  float wiggle_left = 0.12F;    ///< share that remains after the factory correction
  float second_rad = 0;         ///< its second harmonic, of sin(8 phase + 0.3), never corrected
  float stray = 0;              ///< share of the mean phasor of all pixels in every pixel
  float offset_sigma_m = 0;     ///< fixed pattern: each pixel's own error of the distance
  float warm_up_m = 0;          ///< error right after switching on; gone when warm
  double warm_s = 300;          ///< time constant of warming up
  double delay_s = 0;           ///< mid-exposure after that of the colour camera
  bool multipath = false;       ///< one bounce of the light is followed
  double unit_m = 0.001;
  DepthNoise noise;  ///< measured; checked by tests/unit/studio/tof_test.cpp
};

TofSensor tof_sensor(RigPreset rig);
/// The sensor with those imperfections that are switched on.
TofSensor with_realism(TofSensor sensor, RigPreset rig, const Realism& realism);
/// The sensor beside that of preset `first`: on the other side of the target camera. It exposes in
/// the time of a frame that the first leaves, with a millisecond between: less light, more noise.
TofSensor second_sensor(RigPreset rig, RigPreset first);
/// Target camera of a rig; its field of view is narrower than that of the depth camera.
Optics target_optics(RigPreset rig, Size size_px);
/// The fisheye camera below the others, 185 degrees.
FisheyeInfo fisheye_camera();
/// Optics with the same field of view in a picture of another size.
FisheyeOptics scaled(const FisheyeOptics& optics, Size size_px);
/// The camera with a lens error outside the five coefficients: a prism that moves the picture's
/// corner by `error_px`.
Optics with_lens_error(Optics optics, double error_px);
/// Removes the distortion of a camera.
Optics without_distortion(Optics optics);

}  // namespace mixrig::studio
