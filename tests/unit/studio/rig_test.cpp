// SPDX-License-Identifier: Apache-2.0
// The same seed gives the same rig; the head's motion agrees with its axes.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "studio/board/board_studio.h"
#include "studio/rig_of_seed.h"
#include "studio/stage/layout.h"

namespace mixrig::studio {
namespace {

bool same(const Optics& a, const Optics& b) {
  return a.size_px == b.size_px && a.fx_px == b.fx_px && a.fy_px == b.fy_px && a.cx_px == b.cx_px &&
         a.cy_px == b.cy_px && a.distortion == b.distortion;
}
bool same(const geometry::Pose& a, const geometry::Pose& b) {
  return a.translation_m == b.translation_m && a.rotation.coeffs() == b.rotation.coeffs();
}
bool same(const TurnAxis& a, const TurnAxis& b) {
  return a.direction == b.direction && a.point_m == b.point_m && a.scale == b.scale;
}

StudioOptions pan_take(unsigned seed, double tolerance) {
  StudioOptions options;
  options.scenario = Scenario::kPan;
  options.seed = seed;
  options.size_px = {160, 128};
  options.tolerance = tolerance;
  options.threads = 1;
  return options;
}
StudioInfo take_of(unsigned seed, double tolerance) {
  auto studio = Studio::create(pan_take(seed, tolerance));
  EXPECT_TRUE(studio);
  return studio->info();
}
BoardInfo boards_of(unsigned seed, double tolerance) {
  BoardOptions options;
  options.seed = seed;
  options.size_px = {160, 128};
  options.tolerance = tolerance;
  options.threads = 1;
  auto studio = BoardStudio::create(options);
  EXPECT_TRUE(studio);
  return studio->info();
}

TEST(Rig, takes_and_boards_of_a_seed_show_the_same_rig) {
  for (const double tolerance : {0.0, 1.0}) {
    const StudioInfo take = take_of(12, tolerance);
    const BoardInfo boards = boards_of(12, tolerance);
    EXPECT_TRUE(same(take.target, boards.rig.target));
    EXPECT_TRUE(same(take.tof.optics, boards.rig.tof.optics));
    EXPECT_TRUE(same(take.tof.target_from_tof, boards.rig.tof.target_from_tof));
    EXPECT_TRUE(same(take.fisheye.target_from_fisheye, boards.rig.target_from_fisheye));
    EXPECT_EQ(take.fisheye.optics.f_px, boards.rig.fisheye.f_px);
    EXPECT_EQ(take.fisheye.optics.k1, boards.rig.fisheye.k1);
    ASSERT_TRUE(take.pan_tilt);
    EXPECT_TRUE(same(take.pan_tilt->pan, boards.rig.pan_tilt.pan));
    EXPECT_TRUE(same(take.pan_tilt->tilt, boards.rig.pan_tilt.tilt));
  }
}

TEST(Rig, tolerance_zero_is_the_preset_and_seeds_differ_with_tolerance_one) {
  const Optics preset = target_optics(RigPreset::kKinect2, {160, 128});
  EXPECT_TRUE(same(take_of(12, 0).target, preset));
  const StudioInfo a = take_of(12, 1), b = take_of(13, 1);
  EXPECT_NE(a.target.fx_px, b.target.fx_px);
  for (const StudioInfo& info : {a, b}) {
    EXPECT_NE(info.target.fx_px, preset.fx_px);
    EXPECT_NEAR(info.target.fx_px, preset.fx_px, 0.01 * preset.fx_px);
    const geometry::Pose mounted = tof_sensor(RigPreset::kKinect2).target_from_tof;
    EXPECT_LT((info.tof.target_from_tof.translation_m - mounted.translation_m).norm(), 0.007);
    EXPECT_LT(info.tof.target_from_tof.rotation.angularDistance(mounted.rotation), 1.1 * kDeg);
    EXPECT_FALSE(same(info.tof.target_from_tof, mounted));
  }
}

TEST(Rig, boards_have_the_depth_error_of_the_takes) {
  const TofSensor preset = tof_sensor(RigPreset::kKinect2);
  BoardOptions options;
  options.size_px = {160, 128}, options.threads = 1;
  EXPECT_FLOAT_EQ(BoardStudio::create(options)->info().rig.tof.wiggle_rad,
                  preset.wiggle_left * preset.wiggle_rad);
  options.raw_depth = true;
  EXPECT_FLOAT_EQ(BoardStudio::create(options)->info().rig.tof.wiggle_rad, preset.wiggle_rad);
  // 80 MHz: a phase of 2 pi is 1.873703 m.
  options.depth_error_m = 0.015;
  EXPECT_NEAR(BoardStudio::create(options)->info().rig.tof.wiggle_rad,
              0.015 * 2 * std::numbers::pi / 1.873703, 1e-6);
}

TEST(Rig, tolerance_out_of_range_is_refused) {
  for (const double tolerance : {-0.1, 2.1, std::nan("")}) {
    EXPECT_EQ(Studio::create(pan_take(1, tolerance)).error().code, ErrorCode::kUsage);
    BoardOptions options;
    options.tolerance = tolerance;
    EXPECT_EQ(BoardStudio::create(options).error().code, ErrorCode::kUsage);
  }
}

Eigen::Isometry3d turned(const TurnAxis& axis, double reported_rad) {
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  turn.translate(axis.point_m).rotate(Eigen::AngleAxisd(axis.scale * reported_rad, axis.direction));
  return turn.translate(-axis.point_m);
}

TEST(Head, turns_about_its_axes_by_the_angles_that_the_encoders_report) {
  const StudioOptions options = pan_take(12, 0);
  const Layout layout = make_layout(options);
  const PanTiltUnit& unit = layout.pan_tilt;
  // The axes pass neither through the camera nor through each other.
  EXPECT_GT(unit.pan.point_m.norm(), 0.05);
  EXPECT_GT((unit.pan.point_m - unit.tilt.point_m).norm(), 1e-4);
  double widest = 0, largest_off = 0;
  for (double t = 0; t < 10; t += 0.013) {
    const CameraPlace place = camera_at(layout, options, t);
    ASSERT_TRUE(place.head);
    const auto [pan, tilt] = *place.head;
    EXPECT_NEAR(std::remainder(pan, kPanStep_rad), 0, 1e-12);
    EXPECT_NEAR(std::remainder(tilt, kPanStep_rad), 0, 1e-12);
    const Eigen::Isometry3d chain = turned(unit.pan, pan) * turned(unit.tilt, tilt);
    const geometry::Pose rest_from_target =
        geometry::inverse(rest_pose(layout)) * place.world_from_target;
    const Eigen::Quaterniond expected(chain.rotation());
    const double off = rest_from_target.rotation.angularDistance(expected);
    EXPECT_LT(off, std::sqrt(2.0) * (0.5 * kPanStep_rad + 4 * unit.repeatability_rad)) << t;
    EXPECT_LT((rest_from_target.translation_m - chain.translation()).norm(), 0.1 * off + 1e-6) << t;
    widest = std::max(widest, std::abs(pan));
    largest_off = std::max(largest_off, off);
  }
  EXPECT_NEAR(widest, 0.21, kPanStep_rad);
  EXPECT_GT(largest_off, 0.5 * kPanStep_rad) << "the encoders quantise";
}

TEST(Head, pans_as_far_as_wanted_at_the_same_speed) {
  StudioOptions options = pan_take(12, 0);
  options.pan_rad = 0.785;
  const Layout layout = make_layout(options);
  double widest = 0, fastest = 0;
  for (double t = 0; t < 10; t += 0.05) {
    const double pan = camera_at(layout, options, t).head->pan_rad;
    const double later = camera_at(layout, options, t + 0.1).head->pan_rad;
    widest = std::max(widest, std::abs(pan));
    fastest = std::max(fastest, std::abs(later - pan) / 0.1);
  }
  EXPECT_NEAR(widest, 0.785, kPanStep_rad);
  EXPECT_NEAR(fastest, 30 * kDeg, 2 * kPanStep_rad / 0.1);
  options.pan_rad = 0;
  EXPECT_EQ(camera_at(make_layout(options), options, 1.0).head->pan_rad, 0);
}

TEST(Place, is_where_the_options_say) {
  StudioOptions options = pan_take(12, 0);
  options.eye_m = {1.5, 1.0, 1.7};
  options.look_at_m = {4, 2, 1};
  const geometry::Pose rest = rest_pose(make_layout(options));
  EXPECT_EQ(rest.translation_m, *options.eye_m);
  const Eigen::Vector3d ahead = rest.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(ahead.isApprox((*options.look_at_m - *options.eye_m).normalized(), 1e-12));
}

TEST(Place, outside_of_the_room_or_straight_up_is_refused) {
  const auto refused = [](const Eigen::Vector3d& eye_m, const Eigen::Vector3d& look_at_m,
                          double pan_rad) {
    StudioOptions options = pan_take(12, 0);
    options.eye_m = eye_m, options.look_at_m = look_at_m, options.pan_rad = pan_rad;
    const auto studio = Studio::create(options);
    return !studio && studio.error().code == ErrorCode::kUsage;
  };
  EXPECT_TRUE(refused({-1, 2, 1.5}, {4, 2, 1}, 0.2));
  EXPECT_TRUE(refused({1, 2, 9}, {4, 2, 1}, 0.2));
  EXPECT_TRUE(refused({1, 2, std::nan("")}, {4, 2, 1}, 0.2));
  EXPECT_TRUE(refused({1, 2, 1.5}, {1, 2, 2.5}, 0.2)) << "straight up";
  EXPECT_TRUE(refused({1, 2, 1.5}, {1, 2, 1.5}, 0.2));
  EXPECT_TRUE(refused({1, 2, 1.5}, {4, 2, 1}, 2.1));
  EXPECT_FALSE(refused({1, 2, 1.5}, {4, 2, 1}, 2));
}

TEST(Head, turns_at_up_to_30_degrees_a_second) {
  const StudioOptions options = pan_take(12, 0);
  const Layout layout = make_layout(options);
  double fastest = 0;
  for (double t = 0; t < 10; t += 0.01) {
    const Eigen::Quaterniond a = camera_at(layout, options, t).world_from_target.rotation;
    const Eigen::Quaterniond b = camera_at(layout, options, t + 0.01).world_from_target.rotation;
    fastest = std::max(fastest, a.angularDistance(b) / 0.01);
  }
  EXPECT_NEAR(fastest / kDeg, 30, 0.7);
}

TEST(Head, every_frame_of_a_pan_reads_whole_steps_and_other_takes_have_no_head) {
  constexpr double kStep_deg = 0.0514;  // of a PTU-D46
  StudioOptions options = pan_take(12, 1);
  options.rig = RigPreset::kSr3000;
  options.size_px = {64, 48};
  options.frames = 60;
  auto studio = Studio::create(options);
  ASSERT_TRUE(studio);
  Frame frame;
  std::vector<double> pan_steps;
  for (int number = 1; number <= options.frames; number += 12) {
    studio->render(number, frame);
    ASSERT_TRUE(frame.head) << number;
    for (const double angle_rad : {frame.head->pan_rad, frame.head->tilt_rad}) {
      const double steps = angle_rad / kDeg / kStep_deg;
      EXPECT_NEAR(steps, std::round(steps), 1e-6) << number;
    }
    pan_steps.push_back(frame.head->pan_rad / kDeg / kStep_deg);
  }
  const auto [least, most] = std::minmax_element(pan_steps.begin(), pan_steps.end());
  EXPECT_GT(*most - *least, 10);

  options.scenario = Scenario::kHandheld;
  studio = Studio::create(options);
  ASSERT_TRUE(studio);
  studio->render(1, frame);
  EXPECT_FALSE(frame.head);
}

TEST(Rig, StartsAreElsewhereInEachFrameAroundTheScan) {
  StudioOptions options;
  options.scenario = Scenario::kStarts;
  options.seed = 5;
  const Layout layout = make_layout(options);
  const geometry::Pose rest = rest_pose(layout);
  options.scenario = Scenario::kSweep;
  EXPECT_TRUE(same(rest, rest_pose(make_layout(options)))) << "as the scan stands";
  options.scenario = Scenario::kStarts;
  const auto at = [&](double time_s) {
    return camera_at(layout, options, time_s).world_from_target;
  };
  double far_m = 0, far_rad = 0, apart_m = 1;
  for (int frame = 0; frame < 100; ++frame) {
    const geometry::Pose pose = at(frame / kFrameRate_hz);
    EXPECT_TRUE(same(pose, at(frame / kFrameRate_hz + 0.0137))) << "the fisheye's time";
    far_m = std::max(far_m, (pose.translation_m - rest.translation_m).norm());
    far_rad = std::max(far_rad, pose.rotation.angularDistance(rest.rotation));
    apart_m = std::min(apart_m,
                       (at((frame + 1) / kFrameRate_hz).translation_m - pose.translation_m).norm());
    EXPECT_GT(pose.translation_m.minCoeff(), 0.2);
  }
  EXPECT_GT(far_m, 0.9);
  EXPECT_LE(far_m, 1);
  EXPECT_GT(far_rad, 55 * kDeg);
  EXPECT_LE(far_rad, 60 * kDeg + 1e-9);
  EXPECT_GT(apart_m, 0.01);
}

}  // namespace
}  // namespace mixrig::studio
