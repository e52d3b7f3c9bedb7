// SPDX-License-Identifier: Apache-2.0
// Lamps among mirror images, highlights and white things, in a box drawn by formula.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host/room/lamps/lamp_tracks.h"
#include "tests/unit/lamps/drawn_box.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector3d;
using test::DrawnBox;

std::vector<LampView> path(const DrawnBox& box, int views, double length_m) {
  std::vector<LampView> all;
  for (int i = 0; i < views; ++i) {
    const double along = views == 1 ? 0 : length_m * i / (views - 1);
    all.push_back(box.view(test::looking({0.6 + 0.2 * along, 1.2 + along, 1.4}, {1, 0.1, 0.05})));
  }
  return all;
}

bool has(const LampSearch& search, Refusal refusal) {
  return std::any_of(search.rejected.begin(), search.rejected.end(),
                     [&](const RejectedLamp& r) { return r.refusal == refusal; });
}

/// Distance of the found lamp that is nearest.
double off_m(const LampSearch& search, const Vector3d& lamp) {
  double nearest = 1e9;
  for (const FoundLamp& f : search.lamps) nearest = std::min(nearest, (f.position_m - lamp).norm());
  return nearest;
}

TEST(FindLamps, AreWherePanelsAre) {
  const DrawnBox box;
  const auto views = path(box, 11, 1);
  const LampSearch search = find_lamps(views, nullptr);
  ASSERT_EQ(search.lamps.size(), box.lamps.size());
  for (const auto& lamp : box.lamps) EXPECT_LT(off_m(search, lamp.middle_m), 0.015);
  for (const FoundLamp& f : search.lamps) {
    ASSERT_TRUE(f.direction);
    EXPECT_LT(f.direction->z(), -0.99);
    EXPECT_NEAR(f.size_m.x(), 0.5, 0.03);
    EXPECT_NEAR(f.size_m.y(), 0.3, 0.03);
    EXPECT_EQ(f.seen.size(), views.size());
    EXPECT_FALSE(f.by_surface);
  }
}

TEST(FindLamps, ErrorsAreThoseOfTheCovariance) {
  const DrawnBox box;
  const LampSearch search = find_lamps(path(box, 11, 1), nullptr);
  ASSERT_EQ(search.lamps.size(), box.lamps.size());
  for (const auto& lamp : box.lamps) {
    const FoundLamp& f = *std::min_element(
        search.lamps.begin(), search.lamps.end(), [&](const FoundLamp& a, const FoundLamp& b) {
          return (a.position_m - lamp.middle_m).norm() < (b.position_m - lamp.middle_m).norm();
        });
    const Vector3d error = f.position_m - lamp.middle_m;
    EXPECT_LT(error.dot(f.covariance.inverse() * error), 16.3);  // 1 in 1000 of chi2 of 3
    EXPECT_LT(std::sqrt(f.covariance.trace()), 0.01);
  }
}

TEST(FindLamps, APathThatIsTooShortIsSaid) {
  const DrawnBox box;
  const LampSearch search = find_lamps(path(box, 5, 0.004), nullptr);
  EXPECT_TRUE(search.lamps.empty());
  EXPECT_TRUE(has(search, Refusal::kShortPath));
  EXPECT_TRUE(find_lamps({}, nullptr).lamps.empty());
}

TEST(FindLamps, OneViewIsEnoughWhereTheRoomIsKnown) {
  const DrawnBox box;
  const RoomSurfaces room = box.room();
  const LampSearch search = find_lamps(path(box, 1, 0), &room);
  ASSERT_EQ(search.lamps.size(), box.lamps.size());
  for (const auto& lamp : box.lamps) EXPECT_LT(off_m(search, lamp.middle_m), 0.03);
  EXPECT_TRUE(search.lamps.front().by_surface);
}

TEST(FindLamps, AMirrorImageIsBehindTheWall) {
  DrawnBox box;
  box.mirror = true;
  const auto views = path(box, 11, 1);
  const RoomSurfaces room = box.room();
  const LampSearch search = find_lamps(views, &room);
  EXPECT_EQ(search.lamps.size(), box.lamps.size());
  EXPECT_TRUE(has(search, Refusal::kBehind));
  EXPECT_GT(find_lamps(views, nullptr).lamps.size(), box.lamps.size());  // the room tells
}

TEST(FindLamps, AHighlightOnABallMovesWithTheCamera) {
  DrawnBox box;
  box.ball = true;
  const LampSearch search = find_lamps(path(box, 11, 1), nullptr, {.low_lamps = true});
  EXPECT_EQ(search.lamps.size(), box.lamps.size());
}

TEST(FindLamps, WhiteThingsFadeOrLieLow) {
  DrawnBox box;
  box.white_ball = true;
  const auto views = path(box, 11, 1);
  const LampSearch search = find_lamps(views, nullptr);
  EXPECT_EQ(search.lamps.size(), box.lamps.size());
  EXPECT_TRUE(has(search, Refusal::kSoftBorder)) << "its shading fades";
  DrawnBox table;
  table.white_table = true;
  EXPECT_TRUE(has(find_lamps(path(table, 11, 1), nullptr), Refusal::kLow));
  const RoomSurfaces room = table.room();
  EXPECT_TRUE(has(find_lamps(path(table, 11, 1), &room, {.low_lamps = true}), Refusal::kFacesUp));
}

}  // namespace
}  // namespace mixrig::lights
