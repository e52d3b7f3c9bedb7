// SPDX-License-Identifier: Apache-2.0
#include "extras/people/plan/placing.h"

#include <cmath>
#include <numbers>

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

/// Share of a box's sides towards the eye that the screen of the stage leaves visible, by the lines
/// from points of its sides to the eye: shares nothing with the search.
double share_by_sight_lines(const Footprint& box, double x_m, double y_m, double yaw_rad) {
  constexpr int kPoints = 6;
  const Eigen::Vector3d eye = people_camera().translation_m;
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  double seen_m2 = 0, all_m2 = 0;
  const auto look = [&](double u, double v, double z, double m2) {
    const Eigen::Vector3d at(x_m + c * u - s * v, y_m + s * u + c * v, z);
    all_m2 += m2;
    const Eigen::Vector3d in_view = geometry::inverse(people_camera()) * at;
    const Eigen::Vector2d px = people_view().project(in_view);
    if (px.x() < 0 || px.y() < 0 || px.x() > 319 || px.y() > 255) return;
    const double t = (2.5 - eye.x()) / (at.x() - eye.x());
    const Eigen::Vector3d crossed = eye + t * (at - eye);
    if (t < 1 && crossed.y() > 0.4 && crossed.z() < 1.2) return;
    seen_m2 += m2;
  };
  const double w = box.size_m.x(), d = box.size_m.y(), h = box.height_m;
  const double eye_u = c * (eye.x() - x_m) + s * (eye.y() - y_m);
  const double eye_v = -s * (eye.x() - x_m) + c * (eye.y() - y_m);
  for (int j = 0; j < kPoints; ++j)
    for (int i = 0; i < kPoints; ++i) {
      const double a = (i + 0.5) / kPoints - 0.5, b = (j + 0.5) / kPoints - 0.5;
      if (std::abs(eye_u) > w / 2) look(std::copysign(w / 2, eye_u), a * d, (b + 0.5) * h, d * h);
      if (std::abs(eye_v) > d / 2) look(a * w, std::copysign(d / 2, eye_v), (b + 0.5) * h, w * h);
      if (eye.z() > h) look(a * w, b * d, h, w * d);
    }
  return seen_m2 / all_m2;
}

/// Whether the box may be placed there: every point of its outline is at least 0.1 m from the
/// screen and inside the floor, and at least 0.35 m from the path if there is one.
bool may_stand(const Footprint& box, double x_m, double y_m, double yaw_rad, bool with_path) {
  for (double u = -0.5; u <= 0.5; u += 0.1)
    for (double v = -0.5; v <= 0.5; v += 0.1) {
      const Eigen::Vector2d p =
          Eigen::Vector2d(x_m, y_m) +
          Eigen::Rotation2Dd(yaw_rad) * Eigen::Vector2d(u * box.size_m.x(), v * box.size_m.y());
      if (p.x() < 1.6 || p.x() > 5.4 || std::abs(p.y()) > 1.9) return false;
      if (p.x() > 2.4 && p.x() < 2.7 && p.y() > 0.3) return false;
      if (with_path && std::abs(p.x() - 3.6) < 0.35) return false;
    }
  return true;
}

/// Over places 0.08 m and turns 15 deg apart.
TEST(Placing, the_best_visible_share_is_within_five_per_cent_of_brute_force) {
  const Stage stage;
  for (const bool with_path : {false, true})
    for (const Footprint& box : {Footprint{{0.6, 0.4}, 0.8}, Footprint{{1.2, 0.5}, 1.3}}) {
      const auto places =
          suggest_places(stage.map, with_path ? walked_line() : std::vector<Eigen::Vector2d>{}, box,
                         stage.view, 1);
      ASSERT_EQ(places.size(), 1U);
      double best = 0;
      for (double x = 1.6; x < 5.4; x += 0.08)
        for (double y = -1.9; y < 1.9; y += 0.08)
          for (int turn = 0; turn < 12; ++turn) {
            const double yaw_rad = turn * std::numbers::pi / 12;
            if (may_stand(box, x, y, yaw_rad, with_path))
              best = std::max(best, share_by_sight_lines(box, x, y, yaw_rad));
          }
      const FreePlace& p = places[0];
      EXPECT_GT(best, 0.5);
      EXPECT_GE(share_by_sight_lines(box, p.at_m.x(), p.at_m.y(), p.yaw_rad), 0.95 * best);
      EXPECT_NEAR(p.visible_share, share_by_sight_lines(box, p.at_m.x(), p.at_m.y(), p.yaw_rad),
                  0.05);
    }
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
  int whole = 0, cut = 0;  // shadows
  for (const FreePlace& p : places) {
    const Eigen::Vector2d tip = 2 * p.at_m - Eigen::Vector2d(3.5, 0);
    const bool inside = tip.x() > 1.4 && tip.x() < 5.6 && std::abs(tip.y()) < 2.1;
    EXPECT_EQ(p.shadow_share == 1, inside) << p.at_m.transpose();
    ++(inside ? whole : cut);
  }
  EXPECT_GT(whole, 10);
  EXPECT_GT(cut, 10);
}

TEST(Placing, a_box_larger_than_the_floor_has_no_place) {
  const Stage stage;
  EXPECT_TRUE(suggest_places(stage.map, {}, {{6, 1}, 1}, stage.view, 3).empty());
}

}  // namespace
}  // namespace mixrig::plan
