// SPDX-License-Identifier: Apache-2.0
// An operator's changes of a scene: what is written into scene.toml, what stays, what is refused.
#include "host/operator/desk/scene_desk.h"

#include <atomic>
#include <numbers>

#include <gtest/gtest.h>

#include "host/operator/desk/place_sink.h"
#include "tests/unit/run/desk_scene.h"

namespace mixrig::session {
namespace {

TEST(PointOnLevel, IsWhereTheSightMeetsTheFloor) {
  const SeenFrom from = seen_from();
  const auto p = point_on_level(from, {0.5, 0.5}, 0);
  ASSERT_TRUE(p);
  EXPECT_LT((*p - Eigen::Vector3d(0, 2, 0)).norm(), 1e-9) << p->transpose();
  const auto higher = point_on_level(from, {0.5, 0.5}, 1);
  EXPECT_LT((*higher - Eigen::Vector3d(0, 1, 1)).norm(), 1e-9);
  // The inverse mapping at another point.
  const auto q = point_on_level(from, {0.7, 0.8}, 0);
  const auto at = place_in_picture(from, *q);
  ASSERT_TRUE(at);
  EXPECT_LT((*at - Eigen::Vector2d(0.7, 0.8)).norm(), 1e-9);
  EXPECT_NEAR(q->z(), 0, 1e-12);
}

TEST(PointOnLevel, TheSkyHasNoFloor) {
  SeenFrom from = seen_from();
  from.world_from_view.rotation =  // straight ahead
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::UnitX())) *
      from.world_from_view.rotation;
  EXPECT_FALSE(point_on_level(from, {0.5, 0.2}, 0));
  EXPECT_TRUE(point_on_level(from, {0.5, 0.9}, 0));
  EXPECT_FALSE(place_in_picture(from, {0, -1, 0})) << "behind";
}

TEST_F(Desk, ADragIsShownAndWrittenOnRelease) {
  ASSERT_TRUE(desk_->apply(move_to(0.6, 0.6, true), &from_));
  EXPECT_EQ(text(), kDeskScene);
  const auto shown = desk_->objects(&from_);
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_NEAR(shown[0].position_m.z(), 0.5, 1e-9) << "it stays on its level";
  EXPECT_LT((*shown[0].at - Eigen::Vector2d(0.6, 0.6)).norm(), 1e-9);
  ASSERT_TRUE(desk_->apply(move_to(0.7, 0.6, false), &from_));
  const scene::Scene scene = written();
  EXPECT_LT(
      (scene.objects[0].world_from_object.translation_m - *point_on_level(from_, {0.7, 0.6}, 0.5))
          .norm(),
      1e-4);
  EXPECT_EQ(scene.objects[0].scale, 2);
  EXPECT_NE(text().find("# a set"), std::string::npos);
  EXPECT_NE(text().find("# ours"), std::string::npos);
}

TEST_F(Desk, ARefusedDragIsTakenBack) {
  std::string several = kDeskScene;
  const std::size_t at = several.find("position_m = [2");
  ASSERT_NE(at, std::string::npos) << several;
  several.insert(at + std::string("position_m = [").size(), "\n");
  write(several);
  ASSERT_TRUE(desk_->apply(move_to(0.6, 0.6, true), &from_));
  EXPECT_FALSE(desk_->apply(move_to(0.7, 0.6, false), &from_));
  EXPECT_LT((desk_->objects(&from_)[0].position_m - Eigen::Vector3d(2, 3, 0.5)).norm(), 1e-6);
  EXPECT_EQ(text(), several);
}

TEST_F(Desk, TurnScaleAndHiding) {
  page::SetObject set;
  set.name = "crate", set.turn_rad = 1.0, set.scale = 0.5, set.hidden = true;
  ASSERT_TRUE(desk_->apply(set, nullptr));
  const scene::Scene scene = written();
  const scene::Object& object = scene.objects[0];
  const Eigen::Vector3d x = object.world_from_object.rotation * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(std::atan2(x.y(), x.x()), 1.0, 1e-6);
  EXPECT_EQ(object.scale, 0.5);
  EXPECT_TRUE(object.hidden);
  EXPECT_LT((object.world_from_object.translation_m - Eigen::Vector3d(2, 3, 0.5)).norm(), 1e-6);
}

TEST_F(Desk, PreviewsAreSavedTogether) {
  ASSERT_TRUE(desk_->apply(move_to(0.6, 0.6, true), &from_));
  page::SetLamp dim;
  dim.name = "fill", dim.intensity = Eigen::Vector3f(0.1F, 0.1F, 0.2F), dim.preview = true;
  ASSERT_TRUE(desk_->apply(dim));
  EXPECT_EQ(text(), kDeskScene);
  ASSERT_TRUE(desk_->save());
  const scene::Scene scene = written();
  EXPECT_NEAR(scene.light.lamps[1].intensity.z(), 0.2, 1e-6);
  EXPECT_NEAR(scene.light.lamps[0].intensity.x(), 4, 1e-6);
  EXPECT_LT(
      (scene.objects[0].world_from_object.translation_m - *point_on_level(from_, {0.6, 0.6}, 0.5))
          .norm(),
      1e-4);
}

TEST_F(Desk, TwoChangesInARowAreBothInTheFile) {
  page::SetLamp a, b;
  a.name = "key", a.intensity = Eigen::Vector3f(1, 1, 1);
  b.name = "fill", b.on = false;
  ASSERT_TRUE(desk_->apply(a));
  ASSERT_TRUE(desk_->apply(b));
  EXPECT_NEAR(written().light.lamps[0].intensity.y(), 1, 1e-6);
  EXPECT_EQ(written().light.lamps[1].intensity.maxCoeff(), 0);
  b.on = true;
  ASSERT_TRUE(desk_->apply(b));
  EXPECT_NEAR(written().light.lamps[1].intensity.x(), 0.5, 1e-6) << "what it had";
}

TEST_F(Desk, LampsAreAddedAboveAClickAndRemoved) {
  page::AddLamp add;
  add.at = Eigen::Vector2d(0.5, 0.5), add.above_floor_m = 3;
  ASSERT_TRUE(desk_->apply(add, &from_));
  ASSERT_EQ(written().light.lamps.size(), 3U);
  EXPECT_LT((written().light.lamps[2].position_m - Eigen::Vector3d(0, 2, 3)).norm(), 1e-5);
  add.name = "key";
  EXPECT_EQ(desk_->apply(add, &from_).error().code, ErrorCode::kUsage);
  ASSERT_TRUE(desk_->apply(page::RemoveLamp{"key"}));
  ASSERT_EQ(written().light.lamps.size(), 2U);
  EXPECT_EQ(written().light.lamps[0].name, "fill");
}

TEST_F(Desk, ALampIsPutAtAHeightAlongTheSight) {
  page::AddLamp add;
  add.at = Eigen::Vector2d(0.5, 0.5), add.height_m = 1;
  ASSERT_TRUE(desk_->apply(add, &from_));
  EXPECT_LT((written().light.lamps[2].position_m - Eigen::Vector3d(0, 1, 1)).norm(), 1e-5);
  add.height_m = 3;
  EXPECT_EQ(desk_->apply(add, &from_).error().code, ErrorCode::kData) << "the sight goes down";
}

TEST_F(Desk, ALampIsPutWhereItIsSeenInTheRoom) {
  page::AddLamp add;
  add.at = Eigen::Vector2d(0.5, 0.5);
  EXPECT_EQ(desk_->apply(add, &from_).error().code, ErrorCode::kUnsupported) << "no room is known";
  // A wall across the sight, 1.5 m away, with a hole in the middle as a lamp makes it.
  session_.setup.view = from_.view;
  session_.setup.tof = {from_.view, {}};
  model::StaticBackground& wall = session_.background.emplace();
  wall.view = from_.view;
  wall.depth_m.reset(wall.view.size_px, 1.5F);
  wall.depth_sigma_m.reset(wall.view.size_px, 0.01F);
  wall.color.reset(wall.view.size_px, Rgbf{0.5F, 0.5F, 0.5F});
  wall.color_sigma.reset(wall.view.size_px, 0.01F);
  for (int y = 46; y < 55; ++y)
    for (int x = 46; x < 55; ++x) wall.depth_m.at(x, y) = 0;
  ASSERT_TRUE(desk_->apply(add, &from_));
  const Eigen::Vector3d lamp = written().light.lamps[2].position_m;
  const Eigen::Vector3d sight(0, std::sqrt(0.5), -std::sqrt(0.5));
  EXPECT_LT((lamp - (Eigen::Vector3d(0, 0, 2) + 1.45 * sight)).norm(), 0.01) << lamp.transpose();
  wall.depth_m.reset(wall.view.size_px, 0.0F);
  EXPECT_EQ(desk_->apply(add, &from_).error().code, ErrorCode::kData);
}

/// A slanted wall before the camera of seen_from(), with a hole on its left: n . p = 1.5 in the
/// view's axes.
const Eigen::Vector3d kWallNormal = Eigen::Vector3d(0.3, -0.2, 1).normalized();
void put_up_wall(Session& session, const SeenFrom& from) {
  session.setup.view = from.view;
  session.setup.tof = {from.view, {}};
  session.setup.noise = {0.005, 0, 0};
  model::StaticBackground& wall = session.background.emplace();
  wall.view = from.view;
  wall.depth_m.reset(wall.view.size_px);
  wall.depth_sigma_m.reset(wall.view.size_px, 0.01F);
  wall.color.reset(wall.view.size_px, Rgbf{0.5F, 0.5F, 0.5F});
  wall.color_sigma.reset(wall.view.size_px, 0.01F);
  for (int y = 0; y < wall.depth_m.height(); ++y)
    for (int x = 0; x < wall.depth_m.width(); ++x) {
      const Eigen::Vector2d ray = from.view.unproject({x, y});
      const double z = 1.5 / kWallNormal.dot(Eigen::Vector3d(ray.x(), ray.y(), 1));
      wall.depth_m.at(x, y) = x < 20 ? 0.0F : static_cast<float>(z);
    }
}

TEST_F(Desk, AnObjectIsSetOnThePlaneThatIsSeenThere) {
  page::SetObject set;
  set.name = "crate", set.onto = Eigen::Vector2d(0.6, 0.55), set.turn_rad = 0.5;
  EXPECT_EQ(desk_->apply(set, &from_).error().code, ErrorCode::kUnsupported) << "no room is known";
  put_up_wall(session_, from_);
  ASSERT_TRUE(desk_->apply(set, &from_));
  const geometry::Pose pose = written().objects[0].world_from_object;
  const Eigen::Vector3d normal = from_.world_from_view.rotation * -kWallNormal;
  const Eigen::Vector3d up = pose.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_GT(up.dot(normal), std::cos(0.5 * std::numbers::pi / 180)) << up.transpose();
  const Eigen::Vector3d p = inverse(from_.world_from_view) * pose.translation_m;
  EXPECT_NEAR(kWallNormal.dot(p), 1.5, 0.01) << "its lowest corner lies on the plane";
  EXPECT_LT((*place_in_picture(from_, pose.translation_m) - *set.onto).norm(), 0.01);
  const geometry::Pose straight = pose;
  set.turn_rad = 1.5;
  ASSERT_TRUE(desk_->apply(set, &from_));
  const auto turned = written().objects[0].world_from_object.rotation;
  EXPECT_NEAR(turned.angularDistance(straight.rotation), 1.0, 1e-3);
  const std::string before = text();
  set.onto = Eigen::Vector2d(0.05, 0.5);
  const auto refused = desk_->apply(set, &from_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kData);
  EXPECT_EQ(text(), before);
}

TEST_F(Desk, AClickOfTheViewfinderPlacesTheChosenObject) {
  put_up_wall(session_, from_);
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  PlaceSink sink(session_, follower_, orders);
  EXPECT_EQ(orders.state().objects, 1);
  EXPECT_EQ(sink.wanted(1), 0U) << "frames are its business only when something is to be placed";
  auto composite = std::make_shared<output::Composite>();
  composite->world_from_target = from_.world_from_view, composite->view = from_.view;
  ASSERT_TRUE(sink.write(composite));
  EXPECT_EQ(text(), kDeskScene);
  ASSERT_TRUE(orders.give(output::PlaceObject{0, {60, 55}}));
  EXPECT_NE(sink.wanted(2), 0U);
  ASSERT_TRUE(sink.write(composite));
  EXPECT_EQ(sink.wanted(3), 0U);
  EXPECT_EQ(orders.state().placements, 1U);
  EXPECT_EQ(output::text(orders.state().placed), "placed");
  const geometry::Pose pose = written().objects[0].world_from_object;
  EXPECT_LT((from_.view.project(inverse(from_.world_from_view) * pose.translation_m) -
             Eigen::Vector2d(60, 55))
                .norm(),
            0.5);
  const std::string before = text();
  ASSERT_TRUE(orders.give(output::PlaceObject{0, {3, 50}}));  // the hole
  ASSERT_TRUE(sink.write(composite)) << "the run goes on";
  EXPECT_EQ(orders.state().placed, output::Placement::kNoSurface);
  EXPECT_EQ(output::text(output::Placement::kNoSurface).substr(0, 23), "nothing can stand there");
  ASSERT_TRUE(orders.give(output::PlaceObject{7, {60, 55}}));
  ASSERT_TRUE(sink.write(composite));
  EXPECT_EQ(orders.state().placements, 3U);
  EXPECT_EQ(orders.state().placed, output::Placement::kFailed);
  EXPECT_EQ(text(), before);
}

TEST_F(Desk, AModelIsCopiedBesideTheSceneAndStandsOnTheFloor) {
  const auto upload = folder_.path() / "upload.glb";
  std::filesystem::copy_file(folder_.path() / "crate.glb", upload);
  ASSERT_TRUE(desk_->apply(page::AddObject{"a \"tree\"/../x", upload}, &from_));
  const scene::Scene scene = written();
  ASSERT_EQ(scene.objects.size(), 2U);
  EXPECT_EQ(scene.objects[1].name, "a \"tree\"/../x");
  EXPECT_EQ(scene.objects[1].model_path.parent_path(), folder_.path() / "models");
  EXPECT_EQ(scene.objects[1].world_from_object.translation_m.z(), 0);
  ASSERT_TRUE(desk_->apply(page::RemoveObject{"crate"}));
  EXPECT_EQ(written().objects.size(), 1U);
}

TEST_F(Desk, WhatCannotBeIsRefusedAndTheFileStays) {
  std::ofstream(folder_.path() / "bad.glb") << "no model";
  EXPECT_FALSE(desk_->apply(page::AddObject{"bad", folder_.path() / "bad.glb"}, &from_));
  page::SetObject set = move_to(0.5, 0.5, false);
  EXPECT_EQ(desk_->apply(set, nullptr).error().code, ErrorCode::kData) << "no frame yet";
  set.name = "nothing";
  EXPECT_EQ(desk_->apply(set, &from_).error().code, ErrorCode::kNotFound);
  page::SetLamp lamp;
  lamp.name = "nothing", lamp.on = true;
  EXPECT_EQ(desk_->apply(lamp).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(desk_->apply(page::RemoveObject{"nothing"}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(text(), kDeskScene);
  write("[[object]\n");
  EXPECT_FALSE(desk_->apply(page::RemoveObject{"crate"}));
  EXPECT_EQ(text(), "[[object]\n");
}

}  // namespace
}  // namespace mixrig::session
