// SPDX-License-Identifier: Apache-2.0
#include "host/touch/physics.h"

#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/touch/touch_shapes.h"

namespace mixrig::touch {
namespace {

constexpr float kBall_m = 0.11F;

Shape ball() {
  const TestMesh mesh = ball_mesh(kBall_m);
  return make_shape(std::array{mesh.triangles()}, 1.0);
}
geometry::Pose ball_at(double x_m, double z_m = kBall_m) {
  return {Eigen::Quaterniond::Identity(), {x_m, 0, z_m}};
}

TEST(Physics, ABallFallsBouncesAndRests) {
  Physics physics;
  const Body body{.mass_kg = 0.4, .bounce = 0.6, .drag = 0, .is_ball = true};
  const int id = physics.add(ball(), ball_at(0, 1 + kBall_m), &body);
  physics.advance(0);
  const auto height = [&] { return physics.world_from_object()[id].translation_m.z() - kBall_m; };
  physics.advance(0.2), physics.advance(0.4);
  EXPECT_NEAR(height(), 1 - 0.5 * 9.81 * 0.16, 0.02);
  double highest = 0, time_s = 0.4;
  for (; time_s < 0.46; time_s += 0.01) physics.advance(time_s);
  for (; time_s < 1.0; time_s += 0.01)
    physics.advance(time_s), highest = std::max(highest, height());
  const double bounce = 0.6 * 0.6;  // of the ball times that of the floor
  EXPECT_NEAR(highest, bounce * bounce * 1, 0.05);
  for (; time_s < 6; time_s += 0.04) physics.advance(time_s);
  EXPECT_NEAR(height(), 0, 0.005);
}

TEST(Physics, APusherGivesItsSpeedOn) {
  Physics physics;
  const Body body{.mass_kg = 0.4, .bounce = 0.6, .is_ball = true};
  const int id = physics.add(ball(), ball_at(0), &body);
  double time_s = 0;
  for (; time_s < 1.0; time_s += 0.04) {
    // A foot at 1.5 m/s that stops after the kick.
    const float x = std::min(-0.6F + 1.5F * static_cast<float>(time_s), -0.14F);
    const Pusher foot{{x, 0, 0.1F}, {x < -0.14F ? 1.5F : 0.0F, 0, 0}};
    physics.set_pushers(std::array{foot});
    physics.advance(time_s);
  }
  const double x0 = physics.world_from_object()[id].translation_m.x();
  physics.set_pushers({});
  physics.advance(time_s + 0.2);
  const double speed = (physics.world_from_object()[id].translation_m.x() - x0) / 0.24;
  EXPECT_GT(speed, 0.8);
  EXPECT_LT(speed, 3.5);
  EXPECT_NEAR(physics.world_from_object()[id].translation_m.z(), kBall_m, 0.02);
}

TEST(Physics, WallsAndOtherObjectsHold) {
  Physics physics;
  plan::FloorMap room;
  room.corner_m = {-2, -2};
  room.top_m = Image<float>({80, 80});
  for (int y = 0; y < 80; ++y)
    for (int x = 60; x < 64; ++x) room.top_m.at(x, y) = 2;  // a wall from x = 1 on
  physics.set_room(room);
  const Body body{.mass_kg = 0.4, .is_ball = true};
  const int id = physics.add(ball(), ball_at(0), &body);
  const int crate =
      physics.add(box_shape({Eigen::Vector3f(-0.2F, -0.5F, 0), Eigen::Vector3f(0.2F, 0.5F, 1)}),
                  {Eigen::Quaterniond::Identity(), {-1, 0, 0}}, nullptr);
  EXPECT_TRUE(physics.is_moving(id));
  EXPECT_FALSE(physics.is_moving(crate));
  double far = -9, near = 9;
  for (int i = 0; i < 200; ++i) {
    const double time_s = 0.04 * i;
    const float x = -0.3F + 0.08F * static_cast<float>(i);
    if (i < 4) physics.set_pushers(std::array{Pusher{{x, 0, 0.1F}, {2, 0, 0}}});
    if (i == 4) physics.set_pushers({});
    physics.advance(time_s);
    far = std::max(far, physics.world_from_object()[id].translation_m.x());
    near = std::min(near, physics.world_from_object()[id].translation_m.x());
  }
  EXPECT_LT(far, 1.0 - kBall_m + 0.02);
  EXPECT_GT(far, 0.8);
  EXPECT_GT(near, -0.8);
  EXPECT_EQ(physics.world_from_object()[crate].translation_m.x(), -1);
}

std::vector<double> replay(std::size_t pushers) {
  Physics physics;
  const Body body{.mass_kg = 0.4};
  std::vector<int> ids;
  for (int i = 0; i < 4; ++i) ids.push_back(physics.add(ball(), ball_at(0.25 * i, 0.3), &body));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> anywhere(-1, 1);
  std::vector<double> poses;
  for (int frame = 0; frame < 100; ++frame) {
    std::vector<Pusher> balls(pushers + random() % 20);
    for (Pusher& p : balls)
      p = {{anywhere(random), 0.3F * anywhere(random), 0.3F * anywhere(random) + 0.3F},
           {anywhere(random), anywhere(random), anywhere(random)}};
    physics.set_pushers(balls);
    physics.advance(0.04 * frame);
    for (const geometry::Pose& p : physics.world_from_object())
      for (int i = 0; i < 3; ++i)
        poses.push_back(p.translation_m[i]), poses.push_back(p.rotation.coeffs()[i]);
  }
  return poses;
}

TEST(Physics, AReplayGivesTheSameBits) {
  const std::vector<double> a = replay(30), b = replay(30), other = replay(31);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
  EXPECT_NE(std::memcmp(a.data(), other.data(), a.size() * sizeof(double)), 0);
}

TEST(PusherFinder, FollowsASurface) {
  PusherFinder finder;
  std::vector<Eigen::Vector3f> plate;
  const auto fill = [&](float x) {
    plate.clear();
    for (float y = -0.1F; y < 0.1F; y += 0.005F)
      for (float z = 0; z < 0.2F; z += 0.005F) plate.push_back({x, y, z});
  };
  fill(1.0F);
  for (const Pusher& p : finder.find(plate, {0, 0, 0}, 1.0)) EXPECT_EQ(p.velocity_m_s.norm(), 0);
  fill(0.96F);
  const auto pushers = finder.find(plate, {0, 0, 0}, 1.04);
  EXPECT_GT(pushers.size(), 30U);
  EXPECT_LT(pushers.size(), 80U);
  for (const Pusher& p : pushers) {
    EXPECT_NEAR(p.velocity_m_s.x(), -1, 0.01);
    EXPECT_NEAR(p.velocity_m_s.tail<2>().norm(), 0, 0.01);
    EXPECT_NEAR(p.at_m.x(), 0.96 + Pusher::kRadius_m, 0.005);
  }
}

}  // namespace
}  // namespace mixrig::touch
