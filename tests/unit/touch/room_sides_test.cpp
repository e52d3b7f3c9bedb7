// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/room_sides.h"

#include <random>

#include <gtest/gtest.h>

namespace mixrig::touch {
namespace {

/// Points of an upright rectangle and of the floor before it, with noise.
class RoomSidesTest : public ::testing::Test {
 protected:
  void add_side(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, double height_m) {
    const Eigen::Vector2d along = (to_m - from_m).normalized(), across(-along.y(), along.x());
    for (double t = 0; t < (to_m - from_m).norm(); t += 0.013)
      for (double z = 0.01; z < height_m; z += 0.013) {
        const Eigen::Vector2d p = from_m + t * along + noise_(random_) * across;
        points_.push_back({Eigen::Vector3d(p.x(), p.y(), z).cast<float>(), {}});
      }
  }
  /// The floor of x in [0, 3], y in [-2, 2] where `is_free`.
  template <typename IsFree>
  void add_floor(const IsFree& is_free) {
    for (double x = 0; x < 3; x += 0.02)
      for (double y = -2; y < 2; y += 0.02)
        if (is_free(Eigen::Vector2d(x, y)))
          points_.push_back({{static_cast<float>(x), static_cast<float>(y),
                              static_cast<float>(0.3 * noise_(random_))},
                             {}});
  }
  std::vector<RoomSide> sides() const { return find_sides(points_, plan::map_floor(points_)); }

  std::mt19937 random_{3};
  std::normal_distribution<double> noise_{0, 0.006};
  std::vector<plan::RoomPoint> points_;
};

TEST_F(RoomSidesTest, ASlantedWallIsOneSideWhereItIs) {
  for (const double slope : {0.0, 0.3, 1.0}) {
    points_.clear();
    const Eigen::Vector2d from(2, -1.5), to(2 + slope * 0.5, 1.5);
    add_side(from, to, 2.4);
    const Eigen::Vector2d along = (to - from).normalized(), normal(-along.y(), along.x());
    add_floor([&](const Eigen::Vector2d& p) { return normal.dot(p - from) > 0; });
    const auto found = sides();
    ASSERT_EQ(found.size(), 1U) << slope;
    EXPECT_GT(found[0].normal.dot(normal), 0.9998) << slope;  // 1.1 degrees
    EXPECT_NEAR(normal.dot(found[0].from_m - from), 0, 0.005);
    EXPECT_NEAR(normal.dot(found[0].to_m - from), 0, 0.005);
    EXPECT_NEAR((found[0].to_m - found[0].from_m).norm(), (to - from).norm(), 0.1);
    EXPECT_GT(found[0].top_m, 1.9);
  }
}

TEST_F(RoomSidesTest, ACornerIsTwoSidesAndACrateItsOwn) {
  add_side({3, -2}, {3, 2}, 2.4);
  add_side({0, 2}, {3, 2}, 2.4);
  add_side({1, 0}, {1.6, 0}, 0.7);
  add_side({1, 0}, {1, 0.5}, 0.7);
  add_floor([](const Eigen::Vector2d& p) {
    return !(p.x() > 1 && p.x() < 1.6 && p.y() > 0 && p.y() < 0.5);
  });
  const auto found = sides();
  ASSERT_EQ(found.size(), 4U);
  int low = 0;
  for (const RoomSide& side : found) {
    if (side.top_m > 1.5) continue;
    ++low;
    EXPECT_NEAR(side.top_m, 0.7, 0.03);
    // Away from the crate.
    EXPECT_GT(side.normal.dot(Eigen::Vector2d(1, 0) - Eigen::Vector2d(1.3, 0.25)), 0.2);
  }
  EXPECT_EQ(low, 2);
}

TEST_F(RoomSidesTest, APillarAndAFloorHaveNone) {
  add_floor([](const Eigen::Vector2d&) { return true; });
  EXPECT_TRUE(sides().empty());
  for (double angle = 0; angle < 6.28; angle += 0.2)
    add_side({1 + 0.1 * std::cos(angle), 0.1 * std::sin(angle)},
             {1 + 0.1 * std::cos(angle + 0.2), 0.1 * std::sin(angle + 0.2)}, 2);
  EXPECT_TRUE(sides().empty());
  EXPECT_TRUE(find_sides({}, plan::map_floor({})).empty());
}

}  // namespace
}  // namespace mixrig::touch
