// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/physics.h"

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
  EXPECT_NEAR(highest, 0.6 * 0.6 * 1, 0.02);
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

/// A hit of a ball between walls, by formula.
struct TrueHit {
  double time_s, speed_m_s;
  bool is_floor;
};
/// Walls at x = 0 and `room_m`, which the middle of a ball reaches less its radius. No friction.
std::vector<TrueHit> bounces(double x_m, double speed_m_s, double room_m, double z_m, double share,
                             double until_s) {
  std::vector<TrueHit> hits;
  double t = 0, v = speed_m_s, way_m = room_m - kBall_m - x_m;
  for (; (t += way_m / v) < until_s; way_m = room_m - 2 * kBall_m, v *= share)
    hits.push_back({t, v, false});
  v = std::sqrt(2 * 9.81 * (z_m - kBall_m)), t = v / 9.81;
  for (; t < until_s && v > 0.6; v *= share, t += 2 * v / 9.81) hits.push_back({t, v, true});
  std::sort(hits.begin(), hits.end(), [](auto& a, auto& b) { return a.time_s < b.time_s; });
  return hits;
}

TEST(Physics, BallsTellOfEachOtherOnce) {
  Physics physics;
  const Body body{.mass_kg = 0.4, .bounce = 1, .friction = 0, .drag = 0, .is_ball = true};
  for (const double x_m : {0.0, 1.0}) physics.add(ball(), ball_at(x_m), &body);
  physics.set_velocity(0, {2, 0, 0});
  std::vector<Event> hits;
  for (double time_s = 0; time_s < 1; time_s += 0.04) {
    physics.advance(time_s);
    hits.insert(hits.end(), physics.hits().begin(), physics.hits().end());
  }
  ASSERT_EQ(hits.size(), 1U);
  EXPECT_EQ(hits[0].against, Against::kObject);
  EXPECT_EQ(hits[0].object, 0);
  EXPECT_EQ(hits[0].other, 1);
  EXPECT_NEAR(hits[0].time_s, (1 - 2 * kBall_m) / 2, 0.003);
  EXPECT_NEAR(hits[0].speed_m_s, 2, 0.01);
  EXPECT_NEAR((hits[0].at_m - Eigen::Vector3d(1 - kBall_m, 0, kBall_m)).norm(), 0, 0.01);
}

TEST(Physics, ASlantedWallSendsABallWhereTheMirrorDoes) {
  Physics physics;
  const double angle = 0.4;  // of the wall's normal to -x
  const Eigen::Vector2d normal(-std::cos(angle), std::sin(angle)), along(normal.y(), -normal.x());
  const Eigen::Vector2d middle(1.5, 0);
  physics.set_room({}, std::vector<RoomSide>{{middle - along, middle + along, normal, 2.5}});
  const Body body{.mass_kg = 0.4, .bounce = 1, .friction = 0, .drag = 0, .is_ball = true};
  const int id = physics.add(ball(), ball_at(0), &body);
  physics.set_velocity(id, {3, 0, 0});
  int hits = 0;
  const auto at = [&](double time_s) {
    physics.advance(time_s);
    hits += static_cast<int>(physics.hits().size());
    return physics.world_from_object()[id].translation_m;
  };
  for (double time_s = 0; time_s < 0.8; time_s += 0.04) at(time_s);
  const Eigen::Vector3d first = at(0.8), last = at(0.9);
  const Eigen::Vector2d way = (last - first).head<2>() / 0.1;
  const Eigen::Vector2d mirrored =
      Eigen::Vector2d(3, 0) - 2 * normal.dot(Eigen::Vector2d(3, 0)) * normal;
  EXPECT_NEAR((way - mirrored).norm(), 0, 0.05);
  EXPECT_EQ(hits, 1);
}

TEST(Physics, HitsInABoxRoomAreThoseOfTheFormula) {
  constexpr double kRoom_m = 2.03, kShare = 0.8, kUntil_s = 2.5;
  Physics physics;
  std::vector<RoomSide> sides{{{0, -1}, {0, 1}, {1, 0}, 2.5},
                              {{kRoom_m, -1}, {kRoom_m, 1}, {-1, 0}, 2.5}};
  physics.set_room({}, sides);
  const Body body{.mass_kg = 0.4, .bounce = kShare, .friction = 0, .drag = 0, .is_ball = true};
  const int id = physics.add(ball(), ball_at(0.5, 1.2), &body);
  physics.set_velocity(id, {2.9, 0, 0});
  std::vector<Event> hits;
  for (double time_s = 0; time_s < kUntil_s; time_s += 0.04) {
    physics.advance(time_s);
    hits.insert(hits.end(), physics.hits().begin(), physics.hits().end());
  }
  const auto truth = bounces(0.5, 2.9, kRoom_m, 1.2, kShare, kUntil_s);
  ASSERT_GE(truth.size(), 6U);
  ASSERT_EQ(hits.size(), truth.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EXPECT_EQ(hits[i].against, Against::kRoom);
    EXPECT_EQ(hits[i].part, truth[i].is_floor ? RoomPart::kFloor : RoomPart::kWall);
    EXPECT_NEAR(hits[i].time_s, truth[i].time_s, 0.01) << i;
    EXPECT_NEAR(hits[i].speed_m_s, truth[i].speed_m_s, 0.02) << i;
  }
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
