// SPDX-License-Identifier: Apache-2.0
#include "host/plan/placing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/plan/standing_people.h"

namespace mixrig::plan {
namespace {

/// An open floor before the camera, with a screen of 1 m height that hides its left part.
struct Stage {
  std::vector<RoomPoint> points;
  FloorMap map;
  Image<float> depth_m{people_view().size_px};
  RoomView view;

  Stage() {
    for (float x = 1.5F; x < 5.5F; x += 0.02F)
      for (float y = -2; y < 2; y += 0.02F) {
        const bool screen = x > 2.5F && x < 2.6F && y > 0.4F;
        points.push_back({{x, y, screen ? 1.2F : 0.0F}, {90, 90, 90}});
      }
    map = map_floor(points);
    // The screen's front as the camera sees it; nothing else hides.
    for (int y = 0; y < depth_m.height(); ++y)
      for (int x = 0; x < depth_m.width(); ++x) {
        const Eigen::Vector3d ray =
            people_camera().rotation * Eigen::Vector3d((x - 159.5) / 250, (y - 127.5) / 250, 1);
        const double t = 2.5 / ray.x();
        const Eigen::Vector3d at = people_camera().translation_m + t * ray;
        depth_m.at(x, y) = at.y() > 0.4 && at.z() < 1.2 ? static_cast<float>(t) : 0;
      }
    view = {depth_m, people_view(), people_camera()};
  }
};

std::vector<Eigen::Vector2d> walked_line() {
  std::vector<Eigen::Vector2d> path;
  for (double y = -2; y < 2; y += 0.02) path.emplace_back(3.6, y);
  return path;
}

TEST(Placing, no_place_touches_a_path_or_a_thing) {
  const Stage stage;
  const Footprint box{{0.6, 0.4}, 0.8};
  const PlacingOptions options;
  const auto places = suggest_places(stage.map, walked_line(), box, stage.view, 20, options);
  ASSERT_GT(places.size(), 3U);
  for (const FreePlace& p : places) {
    const Eigen::Rotation2Dd turn(p.yaw_rad);
    for (double u = -0.5; u <= 0.5; u += 0.1)
      for (double v = -0.5; v <= 0.5; v += 0.1) {
        const Eigen::Vector2d at = p.at_m + turn * Eigen::Vector2d(0.6 * u, 0.4 * v);
        EXPECT_GE(std::abs(at.x() - 3.6), options.path_margin_m);
        const bool in_screen = at.x() > 2.4 && at.x() < 2.7 && at.y() > 0.3;
        EXPECT_FALSE(in_screen) << at.transpose();
        EXPECT_GT(at.x(), 1.5);
        EXPECT_LT(std::abs(at.y()), 2);
      }
  }
}

/// Finer than the search, over all turns.
TEST(Placing, the_best_visible_share_is_within_five_per_cent_of_brute_force) {
  const Stage stage;
  const Footprint box{{0.6, 0.4}, 0.8};
  const auto places = suggest_places(stage.map, {}, box, stage.view, 1);
  ASSERT_EQ(places.size(), 1U);
  double best = 0;
  for (double x = 1.95; x < 5.1; x += 0.04)
    for (double y = -1.55; y < 1.55; y += 0.04) {
      if (std::abs(x - 2.55) < 0.55 && y > -0.1) continue;
      best = std::max(best, visible_share(box, {x, y}, 0.1, stage.view));
    }
  EXPECT_GE(places[0].visible_share, 0.95 * best);
  EXPECT_NEAR(places[0].visible_share,
              visible_share(box, places[0].at_m, places[0].yaw_rad, stage.view), 1e-12);
}

TEST(Placing, what_the_screen_hides_is_not_seen) {
  const Stage stage;
  const Footprint box{{0.4, 0.4}, 0.5};
  EXPECT_LT(visible_share(box, {3.2, 1.0}, 0, stage.view), 0.1);
  EXPECT_GT(visible_share(box, {3.2, -0.8}, 0, stage.view), 0.95);
}

TEST(Placing, the_shadow_falls_away_from_the_lamp) {
  const Stage stage;
  const Footprint box{{0.4, 0.4}, 1.0};
  PlacingOptions options;
  options.lamp_m = Eigen::Vector3d(3.5, 0, 2.0);  // the shadow is as long as the box is away
  const auto places = suggest_places(stage.map, {}, box, stage.view, 50, options);
  for (const FreePlace& p : places) {
    const Eigen::Vector2d tip = 2 * p.at_m - Eigen::Vector2d(3.5, 0);
    const bool inside = tip.x() > 1.4 && tip.x() < 5.6 && std::abs(tip.y()) < 2.1;
    EXPECT_TRUE(inside || p.shadow_share < 1) << p.at_m.transpose();
  }
}

TEST(Placing, a_box_larger_than_the_floor_has_no_place) {
  const Stage stage;
  EXPECT_TRUE(suggest_places(stage.map, {}, {{6, 1}, 1}, stage.view, 3).empty());
}

}  // namespace
}  // namespace mixrig::plan
