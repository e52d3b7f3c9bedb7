// SPDX-License-Identifier: Apache-2.0
// Phase-based time of flight.
#include "studio/sensors/tof.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mixrig::studio {
namespace {

constexpr float kCycle = 2 * std::numbers::pi_v<float>;

float phase_per_m(double frequency_hz) {
  return static_cast<float>(4 * std::numbers::pi * frequency_hz / kLight_m_s);
}

/// Phase in [0, 2 pi) and amplitude of four taps; false if one is saturated.
bool demodulate(const TofSensor& sensor, const std::array<Echo, 4>& taps, bool fine,
                std::uint64_t key, const NormalTable& normal, float& phase, float& amplitude_e) {
  std::array<float, 4> charge;
  const std::uint64_t bits = mix_bits(key);
  for (int k = 0; k < 4; ++k) {
    const Echo& e = taps[k];
    const float c = fine ? e.fine_cos : e.coarse_cos, s = fine ? e.fine_sin : e.coarse_sin;
    const float turned = k == 0 ? c : k == 1 ? -s : k == 2 ? -c : s;  // cos(phase + k pi / 2)
    const float mean = 0.5F * sensor.signal_e * (e.strength + sensor.contrast * turned) +
                       sensor.background_e * e.albedo;
    const float sigma = std::sqrt(std::max(mean, 0.0F) + sensor.read_noise_e * sensor.read_noise_e);
    charge[k] = mean + sigma * normal(bits >> (12 * k));
    if (charge[k] > sensor.full_well_e) return false;
  }
  const float x = charge[0] - charge[2], y = charge[3] - charge[1];
  amplitude_e = 0.5F * std::hypot(x, y);
  phase = std::atan2(y, x);
  if (phase < 0) phase += kCycle;
  return true;
}

}  // namespace

Echo& Echo::operator+=(const Echo& other) {
  fine_cos += other.fine_cos, fine_sin += other.fine_sin;
  coarse_cos += other.coarse_cos, coarse_sin += other.coarse_sin;
  third_cos += other.third_cos, third_sin += other.third_sin;
  strength += other.strength, albedo += other.albedo;
  return *this;
}

Echo Echo::operator*(float scale) const {
  return {scale * fine_cos,  scale * fine_sin,  scale * coarse_cos, scale * coarse_sin,
          scale * third_cos, scale * third_sin, scale * strength,   scale * albedo};
}

Echo echo_of(const TofSensor& sensor, float distance_m, float infrared_albedo, float cosine) {
  const float strength = infrared_albedo * std::abs(cosine) / (distance_m * distance_m);
  const float fine = phase_per_m(sensor.fine_hz) * distance_m;
  Echo e{.fine_cos = strength * std::cos(fine),
         .fine_sin = strength * std::sin(fine),
         .strength = strength,
         .albedo = infrared_albedo};
  if (sensor.coarse_hz > 0) {
    const float coarse = phase_per_m(sensor.coarse_hz) * distance_m;
    e.coarse_cos = strength * std::cos(coarse), e.coarse_sin = strength * std::sin(coarse);
  }
  if (sensor.third_hz > 0) {
    const float third = phase_per_m(sensor.third_hz) * distance_m;
    e.third_cos = strength * std::cos(third), e.third_sin = strength * std::sin(third);
  }
  return e;
}

double ambiguity_m(double frequency_hz) { return kLight_m_s / (2 * frequency_hz); }

TofValue read_taps(const TofSensor& sensor, const std::array<Echo, 4>& taps, std::uint64_t key,
                   bool raw, const NormalTable& normal, float offset_m) {
  TofValue value;
  float phase = 0;
  if (!demodulate(sensor, taps, true, hash_key(key, 1), normal, phase, value.amplitude_e))
    return {};
  if (value.amplitude_e < sensor.least_amplitude_e) return {0, value.amplitude_e};
  const float left = raw ? 1.0F : sensor.wiggle_left;
  const float second = sensor.second_rad * std::sin(8 * phase + 0.3F);
  phase += left * sensor.wiggle_rad * std::sin(4 * phase + 0.7F);
  phase += second + phase_per_m(sensor.fine_hz) * offset_m;
  float distance = phase / phase_per_m(sensor.fine_hz);
  if (sensor.coarse_hz > 0) {
    float coarse_phase = 0, amplitude = 0;
    if (!demodulate(sensor, taps, false, hash_key(key, 2), normal, coarse_phase, amplitude))
      return {};
    const float coarse = coarse_phase / phase_per_m(sensor.coarse_hz);
    const auto range = static_cast<float>(ambiguity_m(sensor.fine_hz));
    distance += range * std::round((coarse - distance) / range);
    // The two frequencies disagree: mixed depths, or noise.
    if (std::abs(coarse - distance) > 0.3F * range || distance <= 0) return {0, value.amplitude_e};
  }
  const auto unit = static_cast<float>(sensor.unit_m);
  value.distance_m = unit * std::round(distance / unit);
  return value;
}

float warm_up_offset_m(const TofSensor& sensor, unsigned seed, double time_s) {
  const double since_s = 60 + 540.0 * uniform(hash_key(seed, 0x3A24)) + time_s;
  return sensor.warm_up_m * static_cast<float>(std::exp(-since_s / sensor.warm_s));
}

float pixel_offset_m(const TofSensor& sensor, unsigned seed, std::size_t pixel,
                     const NormalTable& normal) {
  return sensor.offset_sigma_m * normal(hash_key(seed, 0xF17ED, pixel));
}

}  // namespace mixrig::studio
