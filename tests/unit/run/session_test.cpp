// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/session.h"

#include <gtest/gtest.h>

#include "host/pose/source/fixed_poses.h"
#include "host/room/background/learn.h"
#include "host/room/scan/room_file.h"
#include "tests/support/box_source.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/run/posed_source.h"

namespace mixrig::session {
namespace {

TEST(Resized, KeepsTheFieldOfViewToThePixelsEdges) {
  const geometry::Pinhole view{{1280, 1024}, 1100, 1050, 640, 500};
  const geometry::Pinhole half = resized(view, {640, 512});
  // The picture's left edge is half a pixel left of pixel 0, whatever the size.
  EXPECT_NEAR(half.unproject({-0.5, -0.5}).x(), view.unproject({-0.5, -0.5}).x(), 1e-12);
  EXPECT_NEAR(half.unproject({639.5, 511.5}).y(), view.unproject({1279.5, 1023.5}).y(), 1e-12);
  EXPECT_DOUBLE_EQ(half.fx_px, 550.0);
}

TEST(Setup, RefusesAViewWithoutPixels) {
  const test::BoxSource source(3, 6);
  for (Size size : {Size{0, 10}, Size{10, -1}, Size{20000, 10}}) {
    EXPECT_TRUE(test::refused(setup_of(source.info(), size), {}, ErrorCode::kUsage));
  }
}

TEST(Setup, WarnsOfCamerasAMetreApart) {
  const test::BoxSource source(3, 6);
  capture::SourceInfo info = source.info();
  const auto said = [&](double away_m) {
    info.target_from_tof.translation_m = {0, away_m, 0};
    testing::internal::CaptureStderr();
    EXPECT_TRUE(setup_of(info, std::nullopt));
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(said(0.3), "");
  EXPECT_NE(said(1.3).find("cameras \"target\" and \"tof\" stand 1.30 m apart: if that is wrong"),
            std::string::npos);
}

TEST(LearnBackground, FindsTheWallAndItsColour) {
  test::BoxSource source(5, 6);
  const auto setup = setup_of(source.info(), std::nullopt);
  ASSERT_TRUE(setup);
  const auto background = learn_background(source, *setup, {1, 5}, {render::Backend::kCpu, 1}, {});
  ASSERT_TRUE(background) << background.error().context;
  EXPECT_NEAR(background->depth_m.at(32, 24), 3.0F, 1e-3F);
  // sRGB 128 is 0.2159 of linear light.
  EXPECT_NEAR(background->color.at(32, 24).g, 0.2159F, 2e-3F);
}

TEST(LearnBackground, RefusesFramesThatTheTakeLacks) {
  test::BoxSource source(5, 6);
  const auto setup = setup_of(source.info(), std::nullopt);
  ASSERT_TRUE(setup);
  for (FrameRange range : {FrameRange{0, 3}, FrameRange{4, 3}, FrameRange{1, 7}}) {
    EXPECT_TRUE(test::refused(learn_background(source, *setup, range, {}, {}), {"1-6"},
                              ErrorCode::kFormat));
  }
}

/// A scanned room of 3 m in all directions, and a scene that names it.
struct RoomScene {
  RoomScene() {
    const Size size{64, 32};
    const model::Panorama p{Image<float>(size, 3.0F), Image<float>(size, 0.01F),
                            Image<std::uint8_t>(size, 2), Image<std::uint8_t>(size, 1),
                            Image<Rgb8>(size, Rgb8{9, 8, 7})};
    EXPECT_TRUE(model::write_room(p, {5, 10, 0, 0, ""}, folder.path()));
    session.source = std::make_unique<test::BoxSource>(5, 6);
    session.setup = setup_of(session.source->info(), std::nullopt).value();
    session.scene.path = "s/scene.toml";
    session.scene.background.model = folder.path();
  }
  test::TemporaryFolder folder;
  Session session;
};

TEST(Session, PlacesAScannedRoomWhereTheSceneSays) {
  RoomScene room;
  room.session.scene.background.world_from_base =
      geometry::Pose{Eigen::Quaterniond::Identity(), {1, 2, 3}};
  const auto prepared = prepare_background(room.session, {});
  ASSERT_TRUE(prepared) << prepared.error().context;
  EXPECT_FALSE(room.session.background);
  ASSERT_FALSE(room.session.setup.background_models.empty());
  const render::BackgroundModel& model = room.session.setup.background_models.front();
  ASSERT_EQ(model.world_from_face.size(), 6U);
  for (const geometry::Pose& face : model.world_from_face)
    EXPECT_EQ(face.translation_m, Eigen::Vector3d(1, 2, 3));
  // The first face looks along y of the base, its picture upright.
  const Eigen::Vector3d ahead = model.world_from_face[0].rotation * Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(ahead.isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_TRUE(render::validate(room.session.setup));
}

TEST(Session, PlacesAScannedRoomAtTheFootOfTheHeadThatGivesThePose) {
  RoomScene room;
  room.session.scene.pose_source = scene::PoseSource::kPanTilt;
  room.session.scene.camera.world_from_base.translation_m = {0, 0, 1.2};
  ASSERT_TRUE(prepare_background(room.session, {}));
  EXPECT_EQ(room.session.setup.background_models.front().world_from_face[3].translation_m.z(), 1.2);
}

TEST(Session, PlacesARoomOfPosedFramesWhereTheyWere) {
  RoomScene room;
  auto file = model::load_room(room.folder.path());
  ASSERT_TRUE(file);
  file->manifest.world_from_base = geometry::Pose{Eigen::Quaterniond::Identity(), {4, 5, 6}};
  ASSERT_TRUE(model::write_room(file->panorama, file->manifest, room.folder.path()));
  const auto prepared = prepare_background(room.session, {});
  ASSERT_TRUE(prepared) << prepared.error().context;
  EXPECT_EQ(room.session.setup.background_models.front().world_from_face[2].translation_m,
            Eigen::Vector3d(4, 5, 6));
}

TEST(Session, LearnedFramesAreJoinedWithARoom) {
  RoomScene room;
  room.session.scene.background.world_from_base.emplace();
  room.session.scene.background.learn = {1, 5};
  room.session.source = std::make_unique<test::PosedSource>(6, [](capture::Capture& c) {
    c.world_from_target.translation_m = {0.5, 0, 0};
    c.pose_origin = capture::PoseOrigin::kRecorded;
  });
  room.session.poses = pose::make_own_poses(true, true);
  EXPECT_EQ(room.session.default_frames(), (FrameRange{6, 6}));
  const auto prepared = prepare_background(room.session, {});
  ASSERT_TRUE(prepared) << prepared.error().context;
  ASSERT_EQ(room.session.setup.background_models.size(), 2U);
  EXPECT_EQ(room.session.setup.background_models[0].world_from_face.size(), 6U);
  ASSERT_EQ(room.session.setup.background_models[1].world_from_face.size(), 1U);
  EXPECT_EQ(room.session.setup.background_models[1].world_from_face[0].translation_m.x(), 0.5);
  EXPECT_TRUE(render::validate(room.session.setup));
}

TEST(Session, FramesWithoutAPoseAreNotJoinedWithARoom) {
  RoomScene room;
  room.session.scene.background.world_from_base.emplace();
  room.session.scene.background.learn = {1, 5};
  room.session.poses = pose::make_own_poses(true, false);
  const auto prepared = prepare_background(room.session, {});
  EXPECT_TRUE(test::refused(prepared, {"joined with a room"}));
}

TEST(Session, FramesBesideABackgroundOfOneViewAreRefused) {
  RoomScene room;
  room.session.scene.background.learn = {1, 5};
  room.session.scene.background.model = room.folder / "view";
  EXPECT_EQ(room.session.default_frames(), (FrameRange{1, 6}));
  const auto prepared = prepare_background(room.session, {});
  EXPECT_TRUE(test::refused(prepared, {"s/scene.toml: background.learn", "of one view"}));
}

TEST(Session, RefusesAScannedRoomWithoutAPlaceAndADamagedOne) {
  RoomScene room;
  auto prepared = prepare_background(room.session, {});
  EXPECT_TRUE(
      test::refused(prepared, {"s/scene.toml: background.model", "background.world_from_base"}));
  room.session.scene.background.world_from_base.emplace();
  room.folder.write("room.exr", "no picture");
  prepared = prepare_background(room.session, {});
  EXPECT_TRUE(test::refused(prepared, {"room.exr"}));
}

TEST(Session, StandsOnlyOnAFloorThatWasFound) {
  Session session;
  session.source = std::make_unique<test::BoxSource>(5, 6);
  session.scene.pose_source = scene::PoseSource::kFloor;
  EXPECT_TRUE(test::refused(prepare_background(session, {}), {"camera.pose"}, ErrorCode::kFormat));
}

TEST(Session, CompositesWhatComesAfterTheLearnedFrames) {
  Session session;
  session.source = std::make_unique<test::BoxSource>(5, 60);
  EXPECT_EQ(session.default_frames(), (FrameRange{1, 60}));
  session.scene.background.learn = {1, 25};
  EXPECT_EQ(session.default_frames(), (FrameRange{26, 60}));
  session.scene.background.learn = {55, 60};
  EXPECT_EQ(session.default_frames(), (FrameRange{1, 54})) << "learned from its last frames";
  session.scene.background.learn = {1, 60};
  EXPECT_EQ(session.default_frames(), (FrameRange{61, 60})) << "none is left";
}

}  // namespace
}  // namespace mixrig::session
