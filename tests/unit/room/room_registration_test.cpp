// SPDX-License-Identifier: Apache-2.0
// Rooms by formula, seen from two places: the pose is known, what is not decided is refused.
#include "host/room/registration/room_registration.h"

#include <cmath>
#include <functional>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "hal/base/angles.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr Size kRegistered{300, 150};

/// Boxes by their corners, in the axes of the world: the room from inside, things from outside.
struct Block {
  Vector3d low_m, high_m;
};

/// Distance to the box; 0 where it is not met. `inside`: its far side.
double hit_m(const Block& box, bool inside, const Vector3d& from, const Vector3d& ray) {
  double enter = -1e9, leave = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double inverse = 1 / (std::abs(ray[k]) > 1e-12 ? ray[k] : 1e-12);
    const double p = (box.low_m[k] - from[k]) * inverse, q = (box.high_m[k] - from[k]) * inverse;
    enter = std::max(enter, std::min(p, q)), leave = std::min(leave, std::max(p, q));
  }
  if (inside) return leave;
  return enter < leave && enter > 0 ? enter : 0;
}

struct BlockWorld {
  Block room{{0, 0, 0}, {5, 4, 3}};
  std::vector<Block> things;
  std::function<Rgb8(const Vector3d&)> color = [](const Vector3d&) { return Rgb8{120, 120, 120}; };
  double farthest_m = 1e9;  ///< nothing is known beyond
};

Panorama blocks_seen_from(const BlockWorld& world, const Pose& world_from_base,
                          double noise_m = 0.002, unsigned seed = 1) {
  Panorama p;
  p.distance_m.reset(kRegistered), p.views.reset(kRegistered, 2), p.field.reset(kRegistered, 1);
  p.sigma_m.reset(kRegistered, static_cast<float>(std::max(0.001, noise_m)));
  p.color.reset(kRegistered);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int y = 0; y < kRegistered.height; ++y)
    for (int x = 0; x < kRegistered.width; ++x) {
      const double azimuth = kPi - 2 * kPi * (x + 0.5) / kRegistered.width;
      const double elevation = kPi / 2 - kPi * (y + 0.5) / kRegistered.height;
      const Vector3d own(-std::sin(azimuth) * std::cos(elevation),
                         std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
      const Vector3d ray = world_from_base.rotation * own;
      double d_m = hit_m(world.room, true, world_from_base.translation_m, ray);
      for (const Block& thing : world.things)
        if (const double t_m = hit_m(thing, false, world_from_base.translation_m, ray); t_m > 0)
          d_m = std::min(d_m, t_m);
      p.color.at(x, y) = world.color(world_from_base.translation_m + d_m * ray);
      p.distance_m.at(x, y) =
          d_m > world.farthest_m ? 0 : static_cast<float>(d_m + noise_m * normal(random));
    }
  return p;
}

Pose standing(double x_m, double y_m, double z_m, double yaw_deg, double tilt_deg = 0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_deg * kDeg, Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(tilt_deg * kDeg, Vector3d::UnitX())),
          {x_m, y_m, z_m}};
}

BlockWorld furnished() {
  BlockWorld world;
  world.things = {
      {{0, 0, 0}, {0.6, 1.8, 2.0}}, {{3.2, 2.9, 0}, {4.6, 4, 0.8}}, {{4.2, 0, 0}, {5, 0.5, 1.4}}};
  return world;
}

Result<Registration> joined(const BlockWorld& at_a, const Pose& a, const BlockWorld& at_b,
                            const Pose& b, const RegistrationOptions& options = {},
                            unsigned seed = 1) {
  Crew crew(2);
  return register_rooms(blocks_seen_from(at_a, a, 0.002, 2 * seed - 1),
                        blocks_seen_from(at_b, b, 0.002, 2 * seed), options, crew);
}

void expect_pose(const Result<Registration>& found, const Pose& a, const Pose& b,
                 double most_m = 0.003, double most_deg = 0.1) {
  ASSERT_TRUE(found) << found.error().context;
  const Pose truth = geometry::inverse(a) * b;
  EXPECT_LT((found->a_from_b.translation_m - truth.translation_m).norm(), most_m);
  EXPECT_LT(found->a_from_b.rotation.angularDistance(truth.rotation) / kDeg, most_deg);
}

std::string why_not(const Result<Registration>& found) {
  return found ? "accepted" : found.error().context;
}

TEST(RoomRegistration, FindsThePoseWithNoise) {
  const BlockWorld world = furnished();
  for (const double yaw_deg : {77.0, -140.0}) {
    const Pose a = standing(1.5, 2.4, 1.4, 20), b = standing(3.3, 1.6, 1.2, yaw_deg, 4);
    const auto found = joined(world, a, world, b);
    ASSERT_NO_FATAL_FAILURE(expect_pose(found, a, b));
    EXPECT_LT(found->runner_up, 0.9);
    EXPECT_GT(found->agreeing_share, 0.97);
    EXPECT_LT(found->held_out_m, 0.004);
    EXPECT_TRUE(found->moved.empty());
    EXPECT_GT(found->sigma_m, 2e-5);
    EXPECT_LT(found->sigma_m, 3e-3);
    EXPECT_GT(found->sigma_rad, 1e-5);
  }
}

TEST(RoomRegistration, AMovedBoxDoesNotPullAndIsNamed) {
  BlockWorld before = furnished(), after = before;
  before.things.push_back({{2.0, 2.9, 0}, {2.9, 3.6, 1.5}});
  after.things.push_back({{2.0, 0.3, 0}, {2.9, 1.0, 1.5}});
  const Pose a = standing(1.5, 2.4, 1.4, 20), b = standing(3.3, 1.8, 1.2, 77);
  const auto found = joined(before, a, after, b);
  ASSERT_NO_FATAL_FAILURE(expect_pose(found, a, b));
  // One box stands in room a, the other in room b.
  const auto points_at = [&](const Pose& from, bool in_b, const Vector3d& middle_m) {
    return std::any_of(found->moved.begin(), found->moved.end(), [&](const MovedArea& area) {
      const Vector3d ray = geometry::inverse(from) * middle_m;
      const double off_deg = area.azimuth_deg - std::atan2(-ray.x(), ray.y()) / kDeg;
      return area.in_b == in_b && std::abs(std::remainder(off_deg, 360)) < 15;
    });
  };
  EXPECT_TRUE(points_at(a, false, {2.5, 3.3, 0.5}));
  EXPECT_TRUE(points_at(b, true, {2.5, 0.6, 0.5}));
}

TEST(RoomRegistration, ABareBoxHasSeveralAnswers) {
  const BlockWorld bare;
  const Pose a = standing(1.5, 2.4, 1.4, 20), b = standing(3.3, 1.8, 1.2, 77);
  EXPECT_NE(why_not(joined(bare, a, bare, b)).find("--near"), std::string::npos)
      << why_not(joined(bare, a, bare, b));
}

TEST(RoomRegistration, APlaceNearbyChooses) {
  const BlockWorld bare;
  const Pose a = standing(1.5, 2.4, 1.4, 20), b = standing(3.3, 1.8, 1.2, 77);
  const Pose near = geometry::inverse(a) * standing(3.1, 1.6, 1.3, 85);
  expect_pose(joined(bare, a, bare, b, {near}), a, b);
  const Pose wrong = geometry::inverse(a) * standing(4.9, 3.9, 1.3, 120);
  EXPECT_FALSE(joined(bare, a, bare, b, {wrong}));
}

TEST(RoomRegistration, ColoursChooseInABareBox) {
  BlockWorld painted;
  painted.color = [](const Vector3d& p) {
    return p.x() < 0.1 ? Rgb8{200, 60, 50} : Rgb8{150, 160, 150};
  };
  const Pose a = standing(1.5, 2.4, 1.4, 20), b = standing(3.3, 1.8, 1.2, 77);
  expect_pose(joined(painted, a, painted, b), a, b);
}

TEST(RoomRegistration, AnotherRoomIsRefused) {
  BlockWorld other = furnished();
  other.room.high_m = {3.6, 6.2, 2.4};
  other.things = {{{1.5, 2.9, 0}, {2.6, 4, 0.8}}};
  const auto found =
      joined(furnished(), standing(1.5, 2.4, 1.4, 20), other, standing(1, 1.6, 1.2, 77));
  EXPECT_NE(why_not(found).find("cannot be joined"), std::string::npos);
}

TEST(RoomRegistration, RoomsWithoutCommonSurfacesAreRefused) {
  BlockWorld world = furnished();
  world.room.high_m = {40, 4, 3};
  BlockWorld corridor = world;
  corridor.room.high_m = {40, 2.2, 2.3};
  world.farthest_m = 4;
  const auto found = joined(world, standing(1.5, 2.4, 1.4, 0), corridor, standing(37, 1, 1.2, 0));
  EXPECT_NE(why_not(found).find("cannot be joined"), std::string::npos);
}

TEST(RoomRegistration, ACorridorSlides) {
  BlockWorld corridor;
  corridor.room = {{-50, 0, 0}, {50, 2, 2.5}};
  corridor.farthest_m = 6;
  const Pose a = standing(0, 1, 1.4, 0), b = standing(1, 1.1, 1.2, 20);
  EXPECT_NE(why_not(joined(corridor, a, corridor, b)).find("holds them along"), std::string::npos);
  const auto near = joined(corridor, a, corridor, b, {geometry::inverse(a) * b});
  EXPECT_NE(why_not(near).find("holds them along"), std::string::npos) << why_not(near);
}

/// A hall of 30 m whose ends are alike; what is further than 6 m is not seen.
BlockWorld hall() {
  BlockWorld world;
  world.room = {{0, 0, 0}, {30, 4, 3}};
  world.farthest_m = 6;
  return world;
}

TEST(RoomRegistration, TwoBareEndsOfAHallAreRefused) {
  const Pose a = standing(2, 2.4, 1.4, 20), b = standing(27.5, 1.8, 1.2, 77);
  const auto found = joined(hall(), a, hall(), b);
  EXPECT_NE(why_not(found).find("one wall alone"), std::string::npos) << why_not(found);
}

TEST(RoomRegistration, OneEndOfAHallIsJoinedWhereAPlaceIsGiven) {
  const Pose a = standing(2, 2.4, 1.4, 20), b = standing(3.5, 1.8, 1.2, 77);
  EXPECT_FALSE(joined(hall(), a, hall(), b));
  expect_pose(joined(hall(), a, hall(), b, {geometry::inverse(a) * b}), a, b);
}

// Pillars every 3 m: a shift by one pillar explains as much.
TEST(RoomRegistration, AHallThatRepeatsIsRefused) {
  BlockWorld pillars = hall();
  pillars.room = {{-60, 0, 0}, {60, 4, 3}};
  for (double x_m = -57; x_m < 58; x_m += 3)
    for (const double y_m : {0.0, 3.5})
      pillars.things.push_back({{x_m, y_m, 0}, {x_m + 0.5, y_m + 0.5, 3}});
  const Pose a = standing(1.8, 2.1, 1.4, 0), b = standing(3.1, 1.8, 1.2, 20);
  const auto found = joined(pillars, a, pillars, b);
  EXPECT_NE(why_not(found).find("fit nearly as well"), std::string::npos) << why_not(found);
}

// The best agreement has one end laid onto the other, which turns the middle around; at the true
// pose the rooms have too little in common.
TEST(RoomRegistration, AFurnishedHallIsNotTurnedAround) {
  BlockWorld furnished_hall = hall();
  furnished_hall.room.high_m.x() = 12;
  furnished_hall.farthest_m = 9;
  furnished_hall.things = {
      {{5, 0, 0}, {6.2, 0.6, 1.8}}, {{7.5, 3.2, 0}, {8.3, 4, 0.9}}, {{3.4, 3.3, 0}, {3.9, 4, 1.2}}};
  const Pose a = standing(3, 2.2, 1.4, -90), b = standing(9, 1.8, 1.2, 80);
  EXPECT_FALSE(joined(furnished_hall, a, furnished_hall, b));
  const auto near = joined(furnished_hall, a, furnished_hall, b, {geometry::inverse(a) * b});
  EXPECT_NE(why_not(near).find("% of their surfaces are seen from both"), std::string::npos)
      << why_not(near);
}

TEST(RoomRegistration, ColoursThatContradictAreRefused) {
  const auto striped = [](double phase) {
    return [phase](const Vector3d& p) {
      const auto v = static_cast<std::uint8_t>(128 + 100 * std::sin(2 * (p.x() + p.y()) + phase));
      return Rgb8{v, v, v};
    };
  };
  BlockWorld at_a = furnished(), at_b = furnished();
  at_a.color = striped(0), at_b.color = striped(kPi / 2);
  const Pose a = standing(1.5, 2.4, 1.4, 20), b = standing(3.3, 1.8, 1.2, 77);
  const auto found = joined(at_a, a, at_b, b);
  EXPECT_NE(why_not(found).find("colours do not"), std::string::npos) << why_not(found);
  expect_pose(joined(at_a, a, at_b, b, {geometry::inverse(a) * b}), a, b);
}

// Both look down, turned half around: their z axes are 16 degrees apart.
TEST(RoomRegistration, HeadsThatLeanAreJoined) {
  const BlockWorld world = furnished();
  const Pose a = standing(1.5, 2.4, 1.4, 20, 8), b = standing(3.3, 1.6, 1.2, -160, 8);
  expect_pose(joined(world, a, world, b), a, b);
}

/// The furnished room whose surfaces are each off by 2 mm.
BlockWorld with_walls_off(std::mt19937& random) {
  std::normal_distribution<double> off_m(0, 0.002);
  BlockWorld world = furnished();
  for (Block* block : {&world.room, &world.things[0], &world.things[1], &world.things[2]})
    for (Vector3d* corner : {&block->low_m, &block->high_m})
      for (double& along_m : *corner) along_m += off_m(random);
  return world;
}

// Walls and pixels are each off by as much as the sigma of a distance.
TEST(RoomRegistration, ErrorsAreThoseOfTheCovariance) {
  const Pose a = standing(1.5, 2.4, 1.4, 20), b = standing(3.3, 1.6, 1.2, 77);
  const Pose truth = geometry::inverse(a) * b;
  double nees = 0;  // for each degree of freedom
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    const BlockWorld at_a = with_walls_off(random), at_b = with_walls_off(random);
    const auto found = joined(at_a, a, at_b, b, {}, seed);
    ASSERT_TRUE(found) << found.error().context;
    const Eigen::AngleAxisd turn(found->a_from_b.rotation * truth.rotation.inverse());
    Eigen::Matrix<double, 6, 1> error;
    error << found->a_from_b.translation_m - truth.translation_m, turn.angle() * turn.axis();
    nees += error.dot(found->covariance.ldlt().solve(error)) / 240;
  }
  EXPECT_NEAR(nees, 1, 0.3);  // 99.9 % of the values that chance gives
}

TEST(RoomRegistration, IsTheSameWithAnyNumberOfThreads) {
  const BlockWorld world = furnished();
  const Panorama a = blocks_seen_from(world, standing(1.5, 2.4, 1.4, 20));
  const Panorama b = blocks_seen_from(world, standing(3.3, 1.6, 1.2, 77), 0.002, 2);
  Crew one(1), three(3);
  const auto p = register_rooms(a, b, {}, one), q = register_rooms(a, b, {}, three);
  ASSERT_TRUE(p && q);
  EXPECT_EQ(p->a_from_b.matrix(), q->a_from_b.matrix());
}

}  // namespace
}  // namespace mixrig::model
