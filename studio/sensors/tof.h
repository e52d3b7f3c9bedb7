// SPDX-License-Identifier: Apache-2.0
// Phase-based time of flight: four taps in sequence, and the distance computed from them.
#pragma once

#include <array>
#include <cstdint>

#include "studio/rig.h"
#include "studio/sensors/noise.h"

namespace mixrig::studio {

inline constexpr double kLight_m_s = 299792458.0;

/// Modulated light on a pixel during one tap: the sum of its sub-rays' phasors. The sum is the
/// cause of mixed depths at edges. Strength is albedo cos / d^2 (1 = albedo 1, perpendicular, at 1
/// m).
struct Echo {
  float fine_cos = 0, fine_sin = 0, coarse_cos = 0, coarse_sin = 0, third_cos = 0, third_sin = 0;
  float strength = 0;
  float albedo = 0;  ///< mean albedo of the surfaces, for the room light

  Echo& operator+=(const Echo& other);
  Echo operator*(float scale) const;
};

/// Echo of one surface `distance_m` away along the ray.
Echo echo_of(const TofSensor& sensor, float distance_m, float infrared_albedo, float cosine);

struct TofValue {
  float distance_m = 0;  ///< along the ray, multiple of the depth unit; 0 = unknown
  float amplitude_e = 0;
};

/// Distance and amplitude from the echoes of the four taps. `key` seeds the pixel's noise; with
/// `raw` the systematic error is not corrected. `offset_m` is added to the distance. Phase from
/// four taps: Lange and Seitz 2001, eq. 4.
TofValue read_taps(const TofSensor& sensor, const std::array<Echo, 4>& taps, std::uint64_t key,
                   bool raw, const NormalTable& normal, float offset_m = 0);
/// Error of all distances while the sensor warms up: it decays from warm_up_m. The take begins one
/// to ten minutes after switching on, by seed.
float warm_up_offset_m(const TofSensor& sensor, unsigned seed, double time_s);
/// A pixel's own error, the same in all frames.
float pixel_offset_m(const TofSensor& sensor, unsigned seed, std::size_t pixel,
                     const NormalTable& normal);

/// Unambiguous range of a modulation frequency.
double ambiguity_m(double frequency_hz);

}  // namespace mixrig::studio
