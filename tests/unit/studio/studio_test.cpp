// SPDX-License-Identifier: Apache-2.0
// Whole frames: reproducible bytes, options, sensors agree with the truth.
#include "studio/studio.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "studio/rig.h"
#include "studio/sensors/lens.h"
#include "studio/stage/layout.h"

namespace mixrig::studio {
namespace {

StudioOptions small(Scenario scenario = Scenario::kWalk) {
  StudioOptions o;
  o.scenario = scenario;
  o.rig = RigPreset::kSr3000;
  o.seed = 7;
  o.frames = 12;
  o.size_px = {80, 64};
  o.threads = 1;
  return o;
}

struct Shot {
  Frame frame;
  Truth truth;
};

Shot shoot(const StudioOptions& options, std::initializer_list<int> numbers) {
  auto studio = Studio::create(options);
  EXPECT_TRUE(studio) << studio.error().context;
  Shot shot;
  for (const int number : numbers) studio->render(number, shot.frame, &shot.truth);
  return shot;
}

template <typename T>
void expect_same(const Image<T>& a, const Image<T>& b, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (int y = 0; y < a.height(); ++y)
    ASSERT_EQ(std::memcmp(a.row(y), b.row(y), sizeof(T) * static_cast<std::size_t>(a.width())), 0)
        << what << " row " << y;
}

void expect_same(const Shot& a, const Shot& b) {
  expect_same(a.frame.color, b.frame.color, "color");
  expect_same(a.frame.tof_distance_m, b.frame.tof_distance_m, "distance");
  expect_same(a.frame.tof_amplitude, b.frame.tof_amplitude, "amplitude");
  expect_same(a.truth.depth_m, b.truth.depth_m, "depth");
  expect_same(a.truth.background_depth_m, b.truth.background_depth_m, "background");
  expect_same(a.truth.matte, b.truth.matte, "matte");
  expect_same(a.truth.light, b.truth.light, "light");
  expect_same(a.truth.composite, b.truth.composite, "composite");
  expect_same(a.truth.labels, b.truth.labels, "labels");
}

TEST(Studio, gives_the_same_bytes_on_one_thread_and_on_two) {
  StudioOptions two = small();
  two.threads = 2;
  expect_same(shoot(small(), {9}), shoot(two, {9}));
}

TEST(Studio, gives_the_same_bytes_in_any_order) {
  expect_same(shoot(small(), {9}), shoot(small(), {2, 11, 9}));
}

TEST(Studio, the_cache_of_static_parts_changes_nothing) {
  StudioOptions slow = small();
  slow.cache = false;
  expect_same(shoot(small(), {8, 10}), shoot(slow, {8, 10}));
}

/// 20 frames, of which the first ten are empty: the camera turns in 2 to 10 and in 16 to 18.
TEST(Studio, a_camera_that_turns_and_rests_keeps_what_it_may) {
  StudioOptions kept = small(Scenario::kShot);
  kept.frames = 20;
  StudioOptions slow = kept;
  slow.cache = false;
  expect_same(shoot(kept, {3, 4}), shoot(slow, {4}));
  expect_same(shoot(kept, {12, 13}), shoot(slow, {13}));
  expect_same(shoot(kept, {13, 17}), shoot(slow, {17}));
  expect_same(shoot(kept, {13, 17, 19, 20}), shoot(slow, {20}));
}

TEST(Studio, a_shot_turns_to_one_side_and_back_before_anybody_comes) {
  StudioOptions options = small(Scenario::kShot);
  options.frames = 100;
  const Layout layout = make_layout(options);
  const auto pan_rad = [&](int frame) {
    return camera_at(layout, options, (frame - 1) / kFrameRate_hz).head->pan_rad;
  };
  EXPECT_EQ(pan_rad(1), 0);
  EXPECT_NEAR(pan_rad(13), options.pan_rad, 0.01);
  for (int frame = 26; frame <= 70; ++frame) EXPECT_EQ(pan_rad(frame), 0) << frame;
  EXPECT_NEAR(pan_rad(81), options.pan_rad / 2, 0.01);
  for (int frame = 92; frame <= 100; ++frame) EXPECT_NEAR(pan_rad(frame), options.pan_rad, 1e-3);
}

TEST(Studio, seeds_differ) {
  StudioOptions other = small();
  other.seed = 8;
  const Shot a = shoot(small(), {9}), b = shoot(other, {9});
  int different = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 80; ++x) different += a.truth.matte.at(x, y) != b.truth.matte.at(x, y);
  EXPECT_GT(different, 100);
}

TEST(Studio, noise_changes_from_frame_to_frame) {
  const Shot a = shoot(small(), {1}), b = shoot(small(), {2});
  int different = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 80; ++x) different += !(a.frame.color.at(x, y) == b.frame.color.at(x, y));
  EXPECT_GT(different, 80 * 64 / 2);
  expect_same(a.truth.composite, b.truth.composite, "composite");
}

/// From the focus change on only the plate differs: the truth stays sharp.
TEST(Studio, a_lens_that_is_focused_anew_changes_the_plates_from_then_on) {
  StudioOptions once = small();
  once.realism.defocus = true;
  StudioOptions anew = once;
  anew.refocus = Refocus{6 / kFrameRate_hz, 0.4};
  expect_same(shoot(once, {5}), shoot(anew, {7, 5}));
  const Shot a = shoot(once, {9}), b = shoot(anew, {9});
  int different = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 80; ++x) different += !(a.frame.color.at(x, y) == b.frame.color.at(x, y));
  EXPECT_GT(different, 80 * 64 / 4);
  expect_same(a.truth.composite, b.truth.composite, "composite");
  anew.realism.defocus = false;
  EXPECT_NE(Studio::create(anew).error().context.find("defocus"), std::string::npos);
}

/// Smallest and largest known distance of the pixels around a position; low > high for none.
struct Reach {
  double low = 1e9, high = 0;
};
Reach around(const Image<float>& distance_m, const Eigen::Vector2d& px) {
  Reach reach;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const int x = static_cast<int>(std::lround(px.x())) + i,
                y = static_cast<int>(std::lround(px.y())) + j;
      if (x < 0 || y < 0 || x >= distance_m.width() || y >= distance_m.height()) continue;
      const double d = distance_m.at(x, y);
      if (d > 0) reach = {std::min(reach.low, d), std::max(reach.high, d)};
    }
  return reach;
}

/// Pixels whose distance is not that of the view's true depth, of those that it sees.
double wrong_share(const TofInfo& tof, const Image<float>& distance_m, const StudioInfo& info,
                   const Truth& truth, std::uint8_t bit) {
  const geometry::Pose tof_from_target = geometry::inverse(tof.target_from_tof);
  int wrong = 0, known = 0;
  for (int y = 2; y < truth.labels.height() - 2; ++y)
    for (int x = 2; x < truth.labels.width() - 2; ++x) {
      if ((truth.labels.at(x, y) & bit) == 0) continue;
      const double z = truth.depth_m.at(x, y);
      const Eigen::Vector3d p =
          tof_from_target * Eigen::Vector3d((x - info.view.cx_px) / info.view.fx_px * z,
                                            (y - info.view.cy_px) / info.view.fy_px * z, z);
      const Reach reach = around(distance_m, project(tof.optics, p));
      if (reach.low > reach.high) continue;
      ++known;
      wrong += p.norm() < reach.low - 0.08 || p.norm() > reach.high + 0.08;
    }
  EXPECT_GT(known, 1000);
  return static_cast<double>(wrong) / known;
}

TEST(Studio, a_second_depth_camera_sees_what_the_first_does_not_and_changes_nothing_else) {
  StudioOptions options = small();
  options.tolerance = 1;
  auto one = Studio::create(options);
  options.second_tof = RigPreset::kHelios2;
  auto two = Studio::create(options);
  ASSERT_TRUE(one && two);
  Frame first, both;
  Truth truth, truth2;
  const int number = one->info().frames;
  one->render(number, first, &truth);
  two->render(number, both, &truth2);
  for (int y = 0; y < first.tof_distance_m.height(); ++y)
    for (int x = 0; x < first.tof_distance_m.width(); ++x)
      ASSERT_EQ(both.tof_distance_m.at(x, y), first.tof_distance_m.at(x, y));
  const StudioInfo& info = two->info();
  ASSERT_TRUE(info.tof2);
  const auto beside = [](const TofInfo& tof) -> Eigen::Vector2d {
    return tof.target_from_tof.translation_m.head<2>();
  };
  EXPECT_LT(beside(info.tof).dot(beside(*info.tof2)), -0.003) << "on the other side";
  EXPECT_LT(wrong_share(*info.tof2, both.tof2_distance_m, info, truth2, Truth::kTof2Sees), 0.03);
  int only_first = 0, only_second = 0;
  for (int y = 0; y < truth2.labels.height(); ++y)
    for (int x = 0; x < truth2.labels.width(); ++x) {
      const std::uint8_t label = truth2.labels.at(x, y);
      ASSERT_EQ(label & ~Truth::kTof2Sees, truth.labels.at(x, y));
      only_first += (label & Truth::kTofSees) != 0 && (label & Truth::kTof2Sees) == 0;
      only_second += (label & Truth::kTofSees) == 0 && (label & Truth::kTof2Sees) != 0;
    }
  EXPECT_GT(only_first, 20);
  EXPECT_GT(only_second, 20);
}

/// The times in which they send light do not meet, not even with the next frame's.
TEST(Studio, two_depth_cameras_expose_one_after_the_other) {
  for (const RigPreset first : {RigPreset::kSr3000, RigPreset::kKinect2, RigPreset::kHelios2})
    for (const RigPreset second : {RigPreset::kSr3000, RigPreset::kKinect2, RigPreset::kHelios2}) {
      const TofSensor a = tof_sensor(first), b = second_sensor(second, first);
      const double before_s = a.delay_s - b.delay_s;
      EXPECT_GT(before_s, 0.5 * (a.exposure_s + b.exposure_s));
      EXPECT_GT(1 / kFrameRate_hz - before_s, 0.5 * (a.exposure_s + b.exposure_s));
    }
}

// Independent of the renderer's ToF rays: uses the true depth of the view and its definition.
TEST(Studio, tof_distances_agree_with_the_truth_of_the_view) {
  for (const RigPreset rig : {RigPreset::kSr3000, RigPreset::kKinect2, RigPreset::kHelios2}) {
    StudioOptions options = small();
    options.rig = rig;
    auto studio = Studio::create(options);
    ASSERT_TRUE(studio);
    Frame frame;
    Truth truth;
    studio->render(1, frame, &truth);
    const StudioInfo& info = studio->info();
    const geometry::Pose tof_from_target = geometry::inverse(info.tof.target_from_tof);
    int near = 0, known = 0, seen = 0;
    for (int y = 2; y < 62; ++y)
      for (int x = 2; x < 78; ++x) {
        seen += (truth.labels.at(x, y) & Truth::kTofSees) != 0;
        if ((truth.labels.at(x, y) & Truth::kTofSees) == 0) continue;
        const double z = truth.depth_m.at(x, y);
        const Eigen::Vector3d p =
            tof_from_target * Eigen::Vector3d((x - info.view.cx_px) / info.view.fx_px * z,
                                              (y - info.view.cy_px) / info.view.fy_px * z, z);
        const Eigen::Vector2d px = project(info.tof.optics, p);
        const Reach reach = around(frame.tof_distance_m, px);
        if (reach.low > reach.high) continue;
        ++known;
        near += p.norm() > reach.low - 0.06 && p.norm() < reach.high + 0.06 ? 1 : 0;
      }
    EXPECT_GT(seen, 0.95 * 60 * 76) << name(rig);
    EXPECT_GT(known, 0.9 * seen) << name(rig);
    EXPECT_GT(near, 0.98 * known) << name(rig);
  }
}

TEST(Studio, fisheye_shows_saturated_lamps_in_a_circle) {
  StudioOptions options = small();
  options.fisheye = true;
  auto studio = Studio::create(options);
  ASSERT_TRUE(studio);
  FisheyePicture frame;
  studio->render_fisheye(1, frame);
  ASSERT_EQ(frame.picture.size(), (Size{1280, 1024}));
  int saturated = 0;
  for (int y = 0; y < frame.picture.height(); ++y)
    for (int x = 0; x < frame.picture.width(); ++x)
      saturated += frame.picture.at(x, y) == Rgb8{255, 255, 255};
  EXPECT_GT(saturated, 50);
  EXPECT_EQ(frame.picture.at(0, 0), Rgb8{});
}

TEST(Studio, wrong_options_are_one_line) {
  StudioOptions options = small();
  options.frames = 1;
  EXPECT_EQ(Studio::create(options).error().code, ErrorCode::kUsage);
  options = small();
  options.size_px = {8, 8};
  EXPECT_NE(Studio::create(options).error().context.find("8x8"), std::string::npos);
  EXPECT_EQ(parse_scenario("dance").error().context,
            "unknown scenario 'dance': use one of still, walk, talk, pan, sweep, handheld, "
            "pendulum, carried, edges, far, dark, starts, rounds, shot");
  EXPECT_EQ(*parse_rig("helios2"), RigPreset::kHelios2);
}

}  // namespace
}  // namespace mixrig::studio
