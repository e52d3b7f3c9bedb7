// SPDX-License-Identifier: Apache-2.0
// Places on the walls of a box, in axes and units of their own, and key pictures in it.
#include "extras/map/reconstruction/maps/map_in_room.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/support/textured_box.h"

namespace mixrig {
namespace {

using Eigen::Vector3d;

const geometry::Pose kRoomFromMap{
    Eigen::Quaterniond(Eigen::AngleAxisd(1.3, Vector3d(1, -2, 2).normalized())), {0.2, -0.3, 0.1}};

struct Placed {
  reconstruction::LearnedMap map;
  std::vector<reconstruction::KeyInRoom> found;
};

Vector3d in_map(const Vector3d& room_m, double scale) {
  return (geometry::inverse(kRoomFromMap) * room_m) / scale;
}

/// Places off by 4 mm, poses by 1 mm and 0.5 mrad; `scale`: metres per unit of the map.
Placed in_box(unsigned seed, double scale) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto vector = [&](double sigma) {
    return Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  Placed placed;
  constexpr double kPlace_m = 0.004, kPose_m = 0.001, kPose_rad = 0.0005;
  for (int i = 0; i < 400; ++i) {
    const Vector3d ray = vector(1).normalized(), eye = Vector3d(0.1, 0.05, 0);
    const Vector3d at = eye + test::TexturedBox::distance_m(eye, ray) * ray;
    reconstruction::MapPoint point;
    point.place = in_map(at + vector(kPlace_m), scale);
    point.covariance = std::pow(kPlace_m / scale, 2) * Eigen::Matrix3d::Identity();
    placed.map.points.push_back(point);
  }
  for (int i = 0; i < 8; ++i) {
    const geometry::Pose pose =
        test::in_the_box({0.04 * i, 0.1 * std::sin(i), 0.02 * i}, Vector3d::Zero());
    reconstruction::MapKey key;
    key.map_from_camera = geometry::inverse(kRoomFromMap) * pose;
    key.map_from_camera.translation_m /= scale;
    placed.map.keys.push_back(key);
    const Vector3d turn = vector(kPose_rad);
    reconstruction::KeyInRoom found;
    found.key = static_cast<std::size_t>(i);
    found.room_from_camera = {
        Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * pose.rotation,
        pose.translation_m + vector(kPose_m)};
    found.covariance.diagonal() << Vector3d::Constant(kPose_rad * kPose_rad),
        Vector3d::Constant(kPose_m * kPose_m);
    placed.found.push_back(found);
  }
  return placed;
}

const model::Panorama& box() {
  static const model::Panorama room = test::TexturedBox().panorama();
  return room;
}

double off_m(const reconstruction::MapInRoom& place, double scale) {
  const Vector3d corner(2, 2, 1);
  return (place.room_from_map * in_map(corner, scale) - corner).norm();
}

TEST(MapInRoom, IsFoundInPlaceAndScale) {
  for (const double scale : {1.0, 4.0})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Placed placed = in_box(seed, scale);
      const auto place = reconstruction::place_in_room(placed.map, box(), placed.found);
      ASSERT_TRUE(place) << place.error().context;
      EXPECT_EQ(place->keys_agree, 8U);
      EXPECT_GT(place->points, 200U);
      EXPECT_GT(place->points_agree, 0.9 * static_cast<double>(place->points));
      EXPECT_LT(off_m(*place, scale), 0.006) << seed;
      EXPECT_NEAR(place->room_from_map.scale / scale, 1, 4 * place->scale_sigma()) << seed;
      EXPECT_LT(place->scale_sigma(), 0.002);
      const auto moved = reconstruction::in_room(placed.map, *place);
      EXPECT_TRUE(moved.room && moved.scale);
      EXPECT_LT((moved.keys[3].map_from_camera.translation_m -
                 placed.found[3].room_from_camera.translation_m)
                    .norm(),
                0.006);
    }
}

TEST(MapInRoom, ThreeKeyPicturesElsewhereDoNotCount) {
  Placed placed = in_box(4, 4.0);
  for (std::size_t i = 0; i < 3; ++i)
    placed.found[i].room_from_camera.translation_m +=
        Vector3d(0.5 + 0.2 * static_cast<double>(i), -0.3, 0.1);
  const auto place = reconstruction::place_in_room(placed.map, box(), placed.found);
  ASSERT_TRUE(place) << place.error().context;
  EXPECT_EQ(place->keys, 8U);
  EXPECT_EQ(place->keys_agree, 5U);
  EXPECT_LT(off_m(*place, 4), 0.01);
}

TEST(MapInRoom, KeyPicturesThatContradictEachOtherAreRefused) {
  Placed placed = in_box(5, 1.0);
  for (std::size_t i = 0; i < placed.found.size(); ++i)
    placed.found[i].room_from_camera.translation_m.y() += i % 2 == 0 ? 0.3 : -0.3;
  const auto place = reconstruction::place_in_room(placed.map, box(), placed.found);
  ASSERT_FALSE(place);
  EXPECT_NE(place.error().context.find("agree on one place"), std::string::npos)
      << place.error().context;
}

TEST(MapInRoom, FewKeyPicturesAreRefused) {
  Placed placed = in_box(6, 1.0);
  placed.found.resize(2);
  EXPECT_FALSE(reconstruction::place_in_room(placed.map, box(), placed.found));
}

TEST(MapInRoom, ARoomWithOtherWallsIsRefused) {
  const Placed placed = in_box(7, 1.0);
  model::Panorama room = box();
  for (int y = 0; y < room.size().height; ++y)
    for (float& d : std::span(room.distance_m.row(y), static_cast<std::size_t>(room.size().width)))
      d *= 0.7F;
  const auto place = reconstruction::place_in_room(placed.map, room, placed.found);
  ASSERT_FALSE(place);
  EXPECT_NE(place.error().context.find("surface"), std::string::npos) << place.error().context;
}

}  // namespace
}  // namespace mixrig
