// SPDX-License-Identifier: Apache-2.0
// Sweep plans are compared with directions that a rotation matrix puts into each view.
#include "host/room/scan/sweep_plan.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace mixrig::model {
namespace {

constexpr double kRad = M_PI / 180;

SweepTask task_of(double field_pan, double field_tilt, double overlap, double most_tilt = 90) {
  return {field_pan * kRad, field_tilt * kRad, 70 * kRad, 60 * kRad, overlap, M_PI,
          most_tilt * kRad};
}

/// Camera axes right, ahead, up; the head turns about up, then about right.
bool in_view(const SweepTask& task, const HeadView& view, const Eigen::Vector3d& ray, double part) {
  const Eigen::Matrix3d base_from_camera =
      (Eigen::AngleAxisd(view.pan_rad, Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(view.tilt_rad, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  const Eigen::Vector3d p = base_from_camera.transpose() * ray;
  return p.y() > 0 && std::atan2(std::abs(p.x()), p.y()) <= 0.5 * part * task.camera_pan_rad &&
         std::atan2(std::abs(p.z()), p.y()) <= 0.5 * part * task.camera_tilt_rad;
}

/// Share of random directions of the field that no view sees.
double missed(const SweepTask& task, const SweepPlan& plan, double part) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  const double top = std::sin(0.5 * task.field_tilt_rad);
  int missing = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const double azimuth = unit(random) * task.field_pan_rad, up = 2 * unit(random) * top;
    const double across = std::sqrt(1 - up * up);
    const Eigen::Vector3d ray(-across * std::sin(azimuth), across * std::cos(azimuth), up);
    bool seen = false;
    for (const HeadView& view : plan.views) seen = seen || in_view(task, view, ray, part);
    missing += seen ? 0 : 1;
  }
  return static_cast<double>(missing) / kRays;
}

TEST(SweepPlan, CoversTheFieldWithPolesAtTheOverlapAskedFor) {
  for (const double overlap : {0.0, 0.2}) {
    const SweepTask task = task_of(270, 180, overlap);
    const auto plan = plan_sweep(task);
    ASSERT_TRUE(plan) << plan.error().context;
    EXPECT_DOUBLE_EQ(plan->covered_share, 1);
    // Half a trial step at the borders of a view.
    EXPECT_LT(missed(task, *plan, 1 - overlap), 0.002) << overlap;
    if (overlap > 0) {
      EXPECT_EQ(missed(task, *plan, 1), 0) << overlap;
    }
  }
}

TEST(SweepPlan, ClosesTheFullCircle) {
  const SweepTask task = task_of(360, 120, 0.1);
  const auto plan = plan_sweep(task);
  ASSERT_TRUE(plan);
  EXPECT_EQ(missed(task, *plan, 1), 0);
  for (std::size_t i = 0; i < plan->views.size(); ++i)
    for (std::size_t k = i + 1; k < plan->views.size(); ++k) {
      const HeadView &a = plan->views[i], &b = plan->views[k];
      EXPECT_TRUE(std::abs(a.tilt_rad - b.tilt_rad) > 1e-6 ||
                  std::abs(std::remainder(a.pan_rad - b.pan_rad, 2 * M_PI)) > 1e-6);
    }
}

TEST(SweepPlan, StaysWithinTheLimitsAndSaysWhatTheyLeaveOut) {
  SweepTask task = task_of(270, 180, 0.1, 40);
  task.most_pan_rad = 60 * kRad;
  const auto plan = plan_sweep(task);
  ASSERT_TRUE(plan) << plan.error().context;
  for (const HeadView& view : plan->views) {
    EXPECT_LE(std::abs(view.tilt_rad), 40 * kRad + 1e-12);
    EXPECT_LE(std::abs(view.pan_rad), 60 * kRad + 1e-12);
  }
  EXPECT_NEAR(plan->covered_share, 1 - missed(task, *plan, 1), 0.02);
  EXPECT_LT(plan->covered_share, 0.75);
  EXPECT_GT(plan->covered_share, 0.5);
}

TEST(SweepPlan, AUnitThatLooksFartherDownThanUpIsUsedToBothLimits) {
  SweepTask task = task_of(120, 180, 0.1, 30);
  task.most_down_rad = 47 * kRad;
  const auto plan = plan_sweep(task);
  ASSERT_TRUE(plan) << plan.error().context;
  const auto level = plan_sweep(task_of(120, 180, 0.1, 30));
  double lowest = 0, highest = 0, highest_of_level = 0;
  for (const HeadView& view : plan->views)
    lowest = std::min(lowest, view.tilt_rad), highest = std::max(highest, view.tilt_rad);
  for (const HeadView& view : level->views)
    highest_of_level = std::max(highest_of_level, view.tilt_rad);
  EXPECT_GE(lowest, -47 * kRad - 1e-12);
  EXPECT_LT(lowest, -31 * kRad);
  EXPECT_EQ(highest, highest_of_level);
  EXPECT_NEAR(plan->covered_share, 1 - missed(task, *plan, 1), 0.02);
  EXPECT_GT(plan->covered_share, level->covered_share + 0.02);
}

TEST(SweepPlan, OneViewIsEnoughForWhatItSees) {
  const auto plan = plan_sweep(task_of(50, 40, 0));
  ASSERT_TRUE(plan);
  ASSERT_EQ(plan->views.size(), 1U);
  EXPECT_EQ(plan->views[0].pan_rad, 0);
  EXPECT_EQ(plan->views[0].tilt_rad, 0);
}

TEST(SweepPlan, MoreOverlapTakesMoreViews) {
  EXPECT_GT(plan_sweep(task_of(180, 120, 0.5))->views.size(),
            1.5 * static_cast<double>(plan_sweep(task_of(180, 120, 0.05))->views.size()));
}

TEST(SweepPlan, SoManyViewsCoverALowerFieldOfTheSameWidth) {
  SweepTask task = task_of(270, 180, 0.1);
  const auto whole = plan_sweep(task);
  ASSERT_TRUE(whole);
  EXPECT_DOUBLE_EQ(whole->field_tilt_rad, task.field_tilt_rad);
  task.most_views = static_cast<int>(whole->views.size()) - 6;
  const auto fewer = plan_sweep(task);
  ASSERT_TRUE(fewer);
  EXPECT_LE(static_cast<int>(fewer->views.size()), task.most_views);
  EXPECT_GT(fewer->field_tilt_rad, 60 * kRad);
  SweepTask lower = task;
  lower.field_tilt_rad = fewer->field_tilt_rad;
  EXPECT_EQ(missed(lower, *fewer, 1), 0);
  EXPECT_NEAR(fewer->covered_share, std::sin(0.5 * fewer->field_tilt_rad), 0.12);
  task.most_views = 2;
  EXPECT_FALSE(plan_sweep(task));
  task.most_views = static_cast<int>(whole->views.size());
  EXPECT_EQ(plan_sweep(task)->views.size(), whole->views.size());
}

TEST(SweepPlan, RefusesValuesOutOfRange) {
  for (const SweepTask& task : {task_of(0, 90, 0.1), task_of(361, 90, 0.1), task_of(90, 181, 0.1),
                                task_of(90, 90, 0.95), task_of(90, 90, -0.1)}) {
    const auto plan = plan_sweep(task);
    ASSERT_FALSE(plan);
    EXPECT_EQ(plan.error().code, ErrorCode::kUsage);
  }
}

}  // namespace
}  // namespace mixrig::model
