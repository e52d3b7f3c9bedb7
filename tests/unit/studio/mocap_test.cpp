// SPDX-License-Identifier: Apache-2.0
// The motion capture stream against the camera's true motion.
#include "studio/mocap.h"

#include <cmath>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "studio/stage/layout.h"

namespace mixrig::studio {
namespace {

StudioOptions handheld(unsigned seed = 12) {
  StudioOptions options;
  options.scenario = Scenario::kHandheld;
  options.seed = seed;
  options.frames = 500;
  return options;
}

/// Time of the take that a sample shows, by the definition in mocap.h.
double shown_s(const MocapSystem& system, double stamp_s) {
  return (stamp_s - system.clock_offset_s) / (1 + system.clock_drift) - system.delay_s;
}

TEST(Mocap, is_empty_for_a_still_camera_and_covers_the_take_of_a_moving_one) {
  StudioOptions options = handheld();
  const MocapSystem system = mocap_of_seed(options.seed);
  options.scenario = Scenario::kWalk;
  EXPECT_TRUE(record_mocap(options, system).empty());
  for (const Scenario moving :
       {Scenario::kHandheld, Scenario::kPendulum, Scenario::kCarried, Scenario::kPan}) {
    options.scenario = moving;
    const auto samples = record_mocap(options, system);
    ASSERT_GT(samples.size(), 2U);
    EXPECT_LT(shown_s(system, samples.front().stamp_s), -0.4);
    EXPECT_GT(shown_s(system, samples.back().stamp_s), (options.frames - 1) / 25.0 + 0.4);
  }
}

TEST(Mocap, shows_the_body_at_the_stated_time_with_the_stated_noise) {
  const StudioOptions options = handheld();
  const Layout layout = make_layout(options);
  const MocapSystem system = mocap_of_seed(options.seed);
  EXPECT_GT(system.body_from_target.translation_m.norm(), 0.05);
  EXPECT_GT(system.clock_offset_s, 19);
  const auto samples = record_mocap(options, system);
  double off2_m = 0, off2_rad = 0;
  for (const MocapSample& sample : samples) {
    const geometry::Pose target =
        camera_at(layout, options, shown_s(system, sample.stamp_s)).world_from_target;
    const geometry::Pose seen = sample.world_from_body * system.body_from_target;
    off2_rad += std::pow(seen.rotation.angularDistance(target.rotation), 2);
    // The error is taken at the body, so that the rotation's noise does not move it.
    const Eigen::Vector3d body_m =
        target * geometry::inverse(system.body_from_target).translation_m;
    off2_m += (sample.world_from_body.translation_m - body_m).squaredNorm();
  }
  // Some 7400 values: a standard deviation of them has a sigma of 0.8 %.
  const double n = 3 * static_cast<double>(samples.size());
  EXPECT_NEAR(std::sqrt(off2_m / n), system.position_sigma_m, 0.04 * system.position_sigma_m);
  EXPECT_NEAR(std::sqrt(off2_rad / n), system.rotation_sigma_rad, 0.04 * system.rotation_sigma_rad);
  EXPECT_NEAR(system.rotation_sigma_rad / kDeg, 0.02, 1e-9);
}

TEST(Mocap, samples_are_120_a_second_of_its_own_clock_and_some_are_lost) {
  const StudioOptions options = handheld();
  MocapSystem system = mocap_of_seed(options.seed);
  EXPECT_NE(system.clock_drift, 0);
  const auto samples = record_mocap(options, system);
  int lost = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double steps = (samples[i].stamp_s - samples[i - 1].stamp_s) * 120;
    EXPECT_NEAR(steps, std::round(steps), 1e-6);
    lost += static_cast<int>(std::lround(steps)) - 1;
  }
  // 2518 samples, 2 %: 50 +- 7.
  EXPECT_GT(lost, 22);
  EXPECT_LT(lost, 78);
  system.lost_share = 0;
  EXPECT_GE(record_mocap(options, system).size(), samples.size() + static_cast<std::size_t>(lost));
}

TEST(Mocap, markers_lie_on_the_body_and_few_are_hidden) {
  const StudioOptions options = handheld();
  const Layout layout = make_layout(options);
  const MocapSystem system = mocap_of_seed(options.seed);
  const geometry::Pose target_from_body = geometry::inverse(system.body_from_target);
  double off2_m = 0;
  std::size_t seen = 0, all = 0;
  for (const MocapSample& sample : record_mocap(options, system)) {
    const geometry::Pose body =
        camera_at(layout, options, shown_s(system, sample.stamp_s)).world_from_target *
        target_from_body;
    for (const Eigen::Vector3d& marker : sample.markers_m) {
      double nearest = 1;
      for (const Eigen::Vector3d& place : system.markers_m)
        nearest = std::min(nearest, (body * place - marker).norm());
      off2_m += nearest * nearest;
    }
    seen += sample.markers_m.size(), all += system.markers_m.size();
  }
  // 12000 markers: a standard deviation has a sigma of 0.4 %, their number one of 11.
  EXPECT_NEAR(std::sqrt(off2_m / (3.0 * static_cast<double>(seen))), system.marker_sigma_m,
              0.02 * system.marker_sigma_m);
  EXPECT_NEAR(static_cast<double>(all - seen), 0.01 * static_cast<double>(all), 50);
}

TEST(Mocap, the_same_seed_gives_the_same_stream_and_another_seed_another_one) {
  const auto stream = [](unsigned seed) {
    return record_mocap(handheld(seed), mocap_of_seed(seed));
  };
  const auto a = stream(12), b = stream(12), c = stream(13);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].stamp_s, b[i].stamp_s);
    EXPECT_EQ(a[i].world_from_body.translation_m, b[i].world_from_body.translation_m);
  }
  EXPECT_NE(a.front().stamp_s, c.front().stamp_s);
  EXPECT_NE(mocap_of_seed(12).body_from_target.translation_m,
            mocap_of_seed(13).body_from_target.translation_m);
}

}  // namespace
}  // namespace mixrig::studio
