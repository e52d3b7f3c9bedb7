// SPDX-License-Identifier: Apache-2.0
// The person: size, feet on the floor, a path around the object.
#include "studio/stage/person.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "studio/stage/light.h"

namespace mixrig::studio {
namespace {

constexpr double kStart_s = 1.0;

Mesh body(const PersonMotion& c, double t) {
  Mesh mesh;
  build_person(c.build(), c.at(t), mesh);
  return mesh;
}

TEST(Person, is_as_tall_as_people_are_and_stands_on_the_floor) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const PersonMotion c(Scenario::kWalk, seed, {}, kStart_s);
    for (const double t : {1.0, 1.33, 1.7, 2.9}) {
      const Bounds box = bounds_of(body(c, t));
      EXPECT_GT(box.high.z(), 1.50F) << seed;
      EXPECT_LT(box.high.z(), 1.95F) << seed;
      EXPECT_GT(box.low.z(), -0.03F) << seed << " " << t;
      EXPECT_LT(box.low.z(), 0.05F) << seed << " " << t;
    }
  }
}

TEST(Person, walks_at_walking_speed_around_the_object) {
  const Stage stage;
  const PersonMotion c(Scenario::kWalk, 5, stage, kStart_s);
  float before = 0, behind = 0, length = 0;
  for (double t = kStart_s; t < kStart_s + 12; t += 0.04) {
    const Vec3 here = c.at(t).pelvis, next = c.at(t + 0.04).pelvis;
    length += (next - here).head<2>().norm();
    before = std::min(before, here.x() - stage.object.x());
    behind = std::max(behind, here.x() - stage.object.x());
  }
  EXPECT_GT(length / 12, 0.8F);
  EXPECT_LT(length / 12, 1.6F);
  EXPECT_LT(before, -0.6F);
  EXPECT_GT(behind, 0.6F);
}

/// In, two and a half times round, a turn, half a lap back, out: without a jump.
TEST(Person, makes_its_rounds_and_goes_out_where_it_came_in) {
  Stage stage;
  stage.way_in_m = 1.8F;
  const PersonMotion c(Scenario::kRounds, 5, stage, kStart_s);
  const auto from_object = [&](double t) -> Vec2 {
    return c.at(t).pelvis.head<2>() - stage.object;
  };
  double angle_rad = 0, most_rad = 0;
  for (double t = kStart_s; t < kStart_s + 30; t += 0.04) {
    const Vec2 a = from_object(t), b = from_object(t + 0.04);
    EXPECT_LT((b - a).norm(), 0.04 * 1.8) << t;
    angle_rad += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    most_rad = std::max(most_rad, std::abs(angle_rad));
  }
  // The straight way in turns by up to a quarter around the object.
  EXPECT_NEAR(most_rad, 2.5 * 2 * kPi, 0.5 * kPi + 0.1);
  EXPECT_GT(most_rad, 2.5 * 2 * kPi);
  EXPECT_NEAR(std::abs(angle_rad), 2 * 2 * kPi, 0.1);  // of the way back half a lap is undone
  EXPECT_LT((from_object(kStart_s + 30) - from_object(kStart_s)).norm(), 0.1F);
}

TEST(Person, keeps_a_standing_foot_in_its_place) {
  const PersonMotion c(Scenario::kWalk, 3, {}, kStart_s);
  int standing = 0;
  for (double t = 2; t < 4; t += 0.02) {
    const Posture a = c.at(t), b = c.at(t + 0.02);
    // At any time at least one foot is flat on the floor and does not slide.
    const auto still = [&](int side) { return (b.ankles[side] - a.ankles[side]).norm() < 1e-4F; };
    standing += still(0) || still(1) ? 1 : 0;
  }
  EXPECT_GT(standing, 75);
}

TEST(Person, differs_from_seed_to_seed_and_not_from_call_to_call) {
  const Mesh a = body(PersonMotion(Scenario::kWalk, 1, {}, kStart_s), 2.0);
  const Mesh again = body(PersonMotion(Scenario::kWalk, 1, {}, kStart_s), 2.0);
  const Mesh b = body(PersonMotion(Scenario::kWalk, 2, {}, kStart_s), 2.0);
  EXPECT_EQ(a.positions, again.positions);
  EXPECT_NE(a.positions, b.positions);
}

TEST(Person, has_unit_normals_everywhere) {
  for (const Scenario scenario :
       {Scenario::kWalk, Scenario::kStill, Scenario::kTalk, Scenario::kEdges}) {
    const Mesh mesh = body(PersonMotion(scenario, 4, {}, kStart_s), 2.3);
    for (const Vec3& n : mesh.normals) ASSERT_NEAR(n.norm(), 1, 1e-4);
  }
}

}  // namespace
}  // namespace mixrig::studio
