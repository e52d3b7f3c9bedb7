// SPDX-License-Identifier: Apache-2.0
// Steps of a learned depth, against the shapes that it and the colours were made of.
#include "host/render/tables/room_edges.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

namespace mixrig::test {
namespace {

constexpr Size kEdgeView{160, 120};
constexpr int kTofPixel_px = 4;

/// An object before a wall or on a floor, and the colours of both; each ToF pixel has the surface
/// in its middle.
struct EdgeRoom {
  using Shape = std::function<float(double x, double y)>;  ///< depth; 0: what is behind is seen
  using Behind = std::function<float(double y)>;
  EdgeRoom(
      const Shape& shape, glm::vec3 near, glm::vec3 far,
      const Behind& behind_m = [](double) { return 4.0F; })
      : depth_m(kEdgeView), truth_m(kEdgeView), color(kEdgeView) {
    std::mt19937 random(5);
    std::normal_distribution<float> normal(0, 0.01F);
    for (int y = 0; y < kEdgeView.height; ++y)
      for (int x = 0; x < kEdgeView.width; ++x) {
        constexpr double kHalf = (kTofPixel_px - 1) / 2.0;
        const int tof_x = x / kTofPixel_px * kTofPixel_px, tof_y = y / kTofPixel_px * kTofPixel_px;
        const float measured = shape(tof_x + kHalf, tof_y + kHalf), true_m = shape(x, y);
        depth_m.at(x, y) = measured > 0 ? measured : behind_m(y);
        truth_m.at(x, y) = true_m > 0 ? true_m : behind_m(y);
        const glm::vec3 c = (true_m > 0 ? near : far) + normal(random);
        color.at(x, y) = {c.r, c.g, c.b};
      }
  }
  Image<float> refined() const {
    return render::depth_at_color_edges({depth_m, {}, color, {}}, kTofPixel_px);
  }
  /// Pixels of another depth than the truth by more than `limit_m`.
  int wrong(const Image<float>& m, float limit_m = 0.1F) const {
    int count = 0;
    for (int y = 0; y < kEdgeView.height; ++y)
      for (int x = 0; x < kEdgeView.width; ++x)
        count += std::abs(m.at(x, y) - truth_m.at(x, y)) > limit_m;
    return count;
  }
  Image<float> depth_m, truth_m;
  Image<Rgbf> color;
};

const glm::vec3 kRed{0.4F, 0.1F, 0.1F}, kGrey{0.3F, 0.3F, 0.3F};

float slanted_board(double x, double y) { return x + 0.37 * y < 90 && y > 30.3 ? 2.0F : 0.0F; }

TEST(RoomEdges, AStepLiesWhereTheColoursHaveIt) {
  const EdgeRoom room(slanted_board, kRed, kGrey);
  const int before = room.wrong(room.depth_m), after = room.wrong(room.refined());
  EXPECT_GT(before, 150);
  EXPECT_LT(after, before / 10);
}

TEST(RoomEdges, ASlatNarrowerThanTwoTofPixelsStays) {
  const EdgeRoom room([](double x, double y) { return std::abs(x - 77.3) < 3.2 && y > 20 ? 2 : 0; },
                      kRed, kGrey);
  const Image<float> refined = room.refined();
  for (int y = 40; y < 110; ++y) EXPECT_NEAR(refined.at(77, y), 2, 0.05F) << y;
  EXPECT_LT(room.wrong(refined), room.wrong(room.depth_m) / 2);
}

TEST(RoomEdges, AFloorKeepsItsSlopeUpToTheEdge) {
  // Seen at a grazing angle, up to a cabinet before it.
  const auto floor_m = [](double y) { return static_cast<float>(1.2 * 140 / (y + 40)); };
  const EdgeRoom room([](double x, double) { return x < 60.4 ? 0.8F : 0; }, kRed, kGrey, floor_m);
  const Image<float> refined = room.refined();
  for (int y = 20; y < 110; ++y)
    for (int x = 61; x < 64; ++x)
      EXPECT_NEAR(refined.at(x, y), floor_m(y), 0.02F * floor_m(y)) << x << "," << y;
  for (int y = 0; y < kEdgeView.height; ++y)
    for (int x = 100; x < 140; ++x) ASSERT_EQ(refined.at(x, y), room.depth_m.at(x, y));
}

TEST(RoomEdges, WhereColoursAreAlikeNoStepBecomesWorse) {
  const EdgeRoom room(slanted_board, kGrey, kGrey);
  EXPECT_LE(room.wrong(room.refined()), 1.1 * room.wrong(room.depth_m));
}

TEST(RoomEdges, AStripWithoutDepthBesideAnEdgeIsTheSurfaceBehind) {
  EdgeRoom room(slanted_board, kRed, kGrey);
  for (int y = 40; y < 110; ++y)
    for (int x = 0; x < 5; ++x)
      room.depth_m.at(static_cast<int>(90 - 0.37 * y) / 4 * 4 + 4 + x, y) = 0;
  const Image<float> refined = room.refined();
  int unknown = 0;
  for (int y = 40; y < 110; ++y)
    for (int x = 0; x < kEdgeView.width; ++x) unknown += !(refined.at(x, y) > 0);
  EXPECT_LT(unknown, 20) << "of 350";
  EXPECT_LT(room.wrong(refined), 60);
}

TEST(RoomEdges, WhatIsUnknownEverywhereOrHasNoColourStays) {
  EdgeRoom room(slanted_board, kRed, kGrey);
  EXPECT_TRUE(render::depth_at_color_edges({room.depth_m, {}, {}, {}}, 4).empty());
  for (int y = 0; y < kEdgeView.height; ++y)
    for (int x = 0; x < kEdgeView.width; ++x) room.color.at(x, y) = {-1, -1, -1};
  const Image<float> same = room.refined();
  for (int y = 0; y < kEdgeView.height; ++y)
    for (int x = 0; x < kEdgeView.width; ++x) ASSERT_EQ(same.at(x, y), room.depth_m.at(x, y));
  room.depth_m.reset(kEdgeView);
  EXPECT_EQ(room.refined().at(5, 5), 0);
  room.depth_m.at(3, 3) = std::numeric_limits<float>::quiet_NaN();
  room.depth_m.at(9, 3) = std::numeric_limits<float>::infinity();
  (void)room.refined();
}

}  // namespace
}  // namespace mixrig::test
