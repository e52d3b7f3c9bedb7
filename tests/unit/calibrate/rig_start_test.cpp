// SPDX-License-Identifier: Apache-2.0
// First model of a rig from corners that were projected by hand, with the finder's mistakes.
#include "host/calibrate/rig/rig_start.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::calibration {
namespace {

constexpr double kDeg = M_PI / 180;
constexpr int kViews = 12, kColumns = 9, kRows = 6;
constexpr double kSquare_m = 0.07;

/// Two cameras, without distortion unless `k1` says so, the second 65 mm below the first and turned
/// by a degree.
struct Truth {
  double f_px[2] = {620, 210}, k1 = 0;
  Size size_px[2] = {{640, 512}, {176, 144}};
  geometry::Pose second_from_first{
      Eigen::Quaterniond(Eigen::AngleAxisd(1 * kDeg, Eigen::Vector3d(0.3, 1, 0.1).normalized())),
      {0.002, -0.065, 0.01}};
};

geometry::Pose held(int view, double tilt_deg) {
  const double about = 2.4 * view, z = 1.0 + 0.08 * view;
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(tilt_deg * kDeg, Eigen::Vector3d(std::cos(about), std::sin(about), 0)));
  const Eigen::Vector3d middle(0.5 * kColumns * kSquare_m, 0.5 * kRows * kSquare_m, 0);
  return {turn, Eigen::Vector3d(0.03 * std::sin(view), 0.02 * std::cos(view), z) - turn * middle};
}

RigData data_of(const Truth& truth, double tilt_deg = 25) {
  RigData data;
  data.set.views = kViews;
  data.set.columns = data.print.columns = kColumns;
  data.set.rows = data.print.rows = kRows;
  data.set.square_m = kSquare_m;
  for (int c = 0; c < 2; ++c) {
    ViewCamera camera;
    camera.name = c == 0 ? "target" : "tof";
    camera.size_px = truth.size_px[c];
    data.set.cameras.push_back(camera);
  }
  data.misfound.resize(2);
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, 0.02);
  for (int view = 0; view < kViews; ++view) {
    data.corners.emplace_back(2);
    for (int c = 0; c < 2; ++c)
      for (int row = 1; row < kRows; ++row)
        for (int column = 1; column < kColumns; ++column) {
          Eigen::Vector3d p =
              held(view, tilt_deg) * Eigen::Vector3d(kSquare_m * column, kSquare_m * row, 0);
          if (c == 1) p = truth.second_from_first * p;
          const double slope = std::hypot(p.x(), p.y()) / p.z();
          const double f = truth.f_px[c] * (1 + truth.k1 * slope * slope);
          data.corners.back()[c].push_back(
              {{column, row},
               {f * p.x() / p.z() + 0.5 * (truth.size_px[c].width - 1) + noise(random),
                f * p.y() / p.z() + 0.5 * (truth.size_px[c].height - 1) + noise(random)}});
        }
  }
  return data;
}

/// The finder shifted the board by a square: not visible in its own camera alone.
void shift(std::vector<SeenCorner>& corners) {
  for (SeenCorner& corner : corners) corner.uv.x() += 1;
}

void expect_refused(RigData data, const char* what) {
  Crew crew(1);
  const auto model = start_rig(data, crew);
  ASSERT_FALSE(model) << what;
  EXPECT_NE(model.error().context.find(what), std::string::npos) << model.error().context;
}

void expect_true(const RigModel& model, const Truth& truth) {
  for (int c = 0; c < 2; ++c) EXPECT_NEAR(model.cameras[c].parameters[0] / truth.f_px[c], 1, 0.01);
  const geometry::Pose& pose = model.cameras[1].camera_from_target;
  EXPECT_LT(pose.rotation.angularDistance(truth.second_from_first.rotation), 0.5 * kDeg);
  EXPECT_LT((pose.translation_m - truth.second_from_first.translation_m).norm(), 0.01);
}

TEST(RigStart, finds_lenses_and_mounting) {
  const Truth truth;
  RigData data = data_of(truth);
  Crew crew(1);
  const auto model = start_rig(data, crew);
  ASSERT_TRUE(model) << model.error().context;
  expect_true(*model, truth);
  for (const Misfound& wrong : data.misfound) EXPECT_EQ(wrong.corners, 0);
}

TEST(RigStart, a_lens_has_the_terms_that_help_on_views_left_out) {
  for (const double k1 : {0.0, -0.2}) {
    Truth truth;
    truth.k1 = k1;
    RigData data = data_of(truth);
    Crew crew(1);
    const auto model = start_rig(data, crew);
    ASSERT_TRUE(model) << model.error().context;
    for (const RigCamera& camera : model->cameras) {
      EXPECT_TRUE(
          geometry::validate(geometry::make_camera(camera.lens, camera.size_px, camera.parameters)))
          << camera.name;
      EXPECT_NEAR(camera.parameters[4], k1, 0.01) << camera.name;
      EXPECT_EQ(camera.free.size(), k1 == 0 ? 4U : 6U) << camera.name;
    }
  }
}

TEST(RigStart, leaves_out_views_and_corners_that_the_finder_got_wrong) {
  const Truth truth;
  RigData data = data_of(truth);
  shift(data.corners[4][1]);
  data.corners[7][1][13].px.x() += 3;
  data.corners[2][0][5].px.y() -= 4;
  Crew crew(1);
  const auto model = start_rig(data, crew);
  ASSERT_TRUE(model) << model.error().context;
  expect_true(*model, truth);
  EXPECT_EQ(data.misfound[0].corners, 1);
  EXPECT_TRUE(data.misfound[0].views.empty());
  EXPECT_EQ(data.misfound[1].views, std::vector{4});
  EXPECT_EQ(data.misfound[1].corners, (kColumns - 1) * (kRows - 1) + 1);
  EXPECT_TRUE(data.corners[4][1].empty());
  EXPECT_EQ(data.corners[2][0].size(), static_cast<std::size_t>((kColumns - 1) * (kRows - 1) - 1));
}

TEST(RigStart, refuses_too_few_views) {
  RigData data = data_of({});
  for (int view = 4; view < kViews; ++view) data.corners[view][1].clear();
  expect_refused(data, "\"tof\" sees the board in 4 of 12 views");
}

TEST(RigStart, refuses_views_that_no_other_camera_shares) {
  RigData data = data_of({});
  for (int view = 0; view < kViews; ++view) data.corners[view][view < 6 ? 0 : 1].clear();
  expect_refused(data, "share 0 views");
}

TEST(RigStart, refuses_views_that_are_all_alike) {
  RigData data = data_of({});
  for (int view = 1; view < kViews; ++view) data.corners[view] = data.corners[0];
  Crew crew(1);
  const auto model = start_rig(data, crew);
  ASSERT_FALSE(model);
}

TEST(RigStart, refuses_corners_that_no_lens_explains) {
  RigData data = data_of({});
  std::mt19937 random(7);
  for (int view = 0; view < kViews; ++view) {
    std::vector<SeenCorner>& corners = data.corners[view][1];
    for (std::size_t i = corners.size() - 1; i > 0; --i)
      std::swap(corners[i].px, corners[random() % (i + 1)].px);
  }
  expect_refused(data, "\"tof\": no pinhole lens explains the corners");
}

}  // namespace
}  // namespace mixrig::calibration
