// SPDX-License-Identifier: Apache-2.0
// The phase sensor against known distances and its stated noise.
#include "studio/sensors/tof.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::studio {
namespace {

constexpr std::array kAllRigs{RigPreset::kSr3000, RigPreset::kKinect2, RigPreset::kHelios2};

struct Statistics {
  double mean = 0, sigma = 0;
  int known = 0;
};

std::array<Echo, 4> four(const Echo& echo) { return {echo, echo, echo, echo}; }

Statistics measure(const TofSensor& sensor, const Echo& echo, bool raw = false, int count = 4000) {
  static const NormalTable normal;
  Statistics s;
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const TofValue v = read_taps(sensor, four(echo), static_cast<std::uint64_t>(i), raw, normal);
    if (v.distance_m == 0) continue;
    ++s.known, sum += v.distance_m, squares += 1.0 * v.distance_m * v.distance_m;
  }
  s.mean = sum / s.known;
  s.sigma = std::sqrt(std::max(0.0, squares / s.known - s.mean * s.mean));
  return s;
}

TEST(Tof, measures_the_distance_of_a_wall) {
  for (const RigPreset rig : kAllRigs) {
    const TofSensor sensor = tof_sensor(rig);
    for (const float d : {1.2F, 2.0F, 2.7F, 3.3F, 4.1F, 5.0F}) {
      const Statistics s = measure(sensor, echo_of(sensor, d, 0.5F, 1));
      EXPECT_EQ(s.known, 4000) << name(rig) << " " << d;
      EXPECT_NEAR(s.mean, d, 0.0025) << name(rig);
    }
  }
}

TEST(Tof, noise_is_as_stated_in_the_take) {
  for (const RigPreset rig : kAllRigs) {
    const TofSensor sensor = tof_sensor(rig);
    for (const float d : {1.5F, 2.0F, 3.0F, 4.0F, 5.0F}) {
      const double declared =
          sensor.noise.floor_m + sensor.noise.linear * d + sensor.noise.quadratic_per_m * d * d;
      const double sigma = measure(sensor, echo_of(sensor, d, 0.5F, 1)).sigma;
      EXPECT_NEAR(sigma, declared, 0.1 * declared) << name(rig) << " " << d;
    }
  }
}

TEST(Tof, raw_depth_keeps_a_systematic_error) {
  const TofSensor sensor = tof_sensor(RigPreset::kSr3000);
  double worst = 0;
  for (float d = 1; d < 5; d += 0.1F)
    worst =
        std::max(worst, std::abs(measure(sensor, echo_of(sensor, d, 0.8F, 1), true, 400).mean - d));
  EXPECT_GT(worst, 0.012);
  EXPECT_LT(worst, 0.018);
}

TEST(Tof, distance_wraps_at_the_ambiguity_of_20_mhz) {
  const TofSensor sensor = tof_sensor(RigPreset::kSr3000);
  EXPECT_NEAR(ambiguity_m(sensor.fine_hz), 7.4948, 1e-3);
  EXPECT_NEAR(measure(sensor, echo_of(sensor, 8.2F, 0.9F, 1)).mean, 8.2 - 7.4948, 0.003);
}

TEST(Tof, two_frequencies_do_not_wrap_inside_the_room) {
  const TofSensor sensor = tof_sensor(RigPreset::kKinect2);
  EXPECT_NEAR(measure(sensor, echo_of(sensor, 6.9F, 0.9F, 1)).mean, 6.9, 0.004);
}

TEST(Tof, an_edge_pixel_measures_a_depth_between_the_two_it_mixes) {
  const TofSensor sensor = tof_sensor(RigPreset::kSr3000);
  // Albedo in proportion to the distance squared: both halves are equally strong.
  Echo even = echo_of(sensor, 2, 0.4F, 1) * 0.5F;
  even += echo_of(sensor, 3, 0.9F, 1) * 0.5F;
  EXPECT_NEAR(measure(sensor, even).mean, 2.5, 0.01);
  for (const float share : {0.1F, 0.3F, 0.7F, 0.9F}) {
    Echo mixed = echo_of(sensor, 2, 0.5F, 1) * share;
    mixed += echo_of(sensor, 3, 0.5F, 1) * (1 - share);
    const double mean = measure(sensor, mixed).mean;
    EXPECT_GT(mean, 2.01) << share;
    EXPECT_LT(mean, 2.99) << share;
  }
}

TEST(Tof, motion_between_the_taps_smears) {
  const TofSensor sensor = tof_sensor(RigPreset::kSr3000);
  static const NormalTable normal;
  const Echo near = echo_of(sensor, 2, 0.5F, 1), far = echo_of(sensor, 3.5F, 0.5F, 1);
  const TofValue v = read_taps(sensor, {near, near, far, far}, 1, false, normal);
  EXPECT_GT(std::abs(v.distance_m - 2.0F), 0.05F);
  EXPECT_GT(std::abs(v.distance_m - 3.5F), 0.05F);
}

TEST(Tof, too_dark_and_too_bright_are_unknown) {
  for (const RigPreset rig : kAllRigs) {
    const TofSensor sensor = tof_sensor(rig);
    EXPECT_EQ(measure(sensor, echo_of(sensor, 4.5F, 0.01F, 1)).known, 0) << name(rig);
    EXPECT_EQ(measure(sensor, echo_of(sensor, 0.25F, 0.9F, 1)).known, 0) << name(rig);
    EXPECT_EQ(measure(sensor, Echo{}).known, 0) << name(rig);
  }
}

TEST(Tof, gaussian_table_has_unit_spread) {
  const NormalTable normal;
  double sum = 0, squares = 0;
  for (std::uint64_t i = 0; i < 4096; ++i) sum += normal(i), squares += normal(i) * normal(i);
  EXPECT_NEAR(sum / 4096, 0, 1e-6);
  EXPECT_NEAR(squares / 4096, 1, 0.003);
}

}  // namespace
}  // namespace mixrig::studio
