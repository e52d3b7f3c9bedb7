// SPDX-License-Identifier: Apache-2.0
// Time of flight by phase: four taps, one after another, and what a sensor makes of them.
#pragma once

#include <array>
#include <cstdint>

#include "host/studio/noise.h"
#include "host/studio/rig.h"

namespace mixrig::studio {

/// Modulated light that falls on a pixel during one tap: the sum of its sub-rays' phasors, which
/// is what mixes depths at edges. Strengths are albedo cos / d^2 (1 = albedo 1, facing, at 1 m).
struct Echo {
  float fine_cos = 0, fine_sin = 0, coarse_cos = 0, coarse_sin = 0;
  float strength = 0;
  float albedo = 0;  ///< that room light falls on

  Echo& operator+=(const Echo& other);
  Echo operator*(float scale) const;
};

/// Echo of one surface `distance_m` away along the ray.
Echo echo_of(const TofSensor& sensor, float distance_m, float infrared_albedo, float cosine);

struct TofValue {
  float distance_m = 0;  ///< along the ray, whole units; 0 = unknown
  float amplitude_e = 0;
};

/// What the sensor reads from the echoes of its four taps. `key` seeds the pixel's noise;
/// `raw` leaves the systematic error in. Phase from four taps: Lange and Seitz 2001, eq. 4.
TofValue read_taps(const TofSensor& sensor, const std::array<Echo, 4>& taps, std::uint64_t key,
                   bool raw, const NormalTable& normal);

/// Distance after which the phase of a frequency repeats.
double ambiguity_m(double frequency_hz);

}  // namespace mixrig::studio
