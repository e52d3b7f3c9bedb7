// SPDX-License-Identifier: Apache-2.0
// Both back ends draw the same background at each pose and through each lens.
#include <gtest/gtest.h>

#include "tests/gl/whole_frame_pair.h"
#include "tests/support/face_model.h"

namespace mixrig::test {
namespace {

/// The room's still background serves as a model that is drawn for each pose.
TEST(WholeFrame, agrees_with_a_background_model_at_every_pose) {
  RoomSetup room(RoomSetup::Options{});
  room.draw_background_for_each_pose();
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  expect_agreement(pair, frame);
  // Plate and depth stay those of the first pose: the test compares the back ends only.
  frame.world_from_target.translation_m = {0.02, 0.01, 0};
  expect_agreement(pair, frame);
  frame.world_from_target.rotation =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()) * frame.world_from_target.rotation;
  expect_agreement(pair, frame);
}

/// The object stands before a mirror whose depth has wrapped around, and on a floor whose learned
/// depth is too large.
TEST(WholeFrame, agrees_where_light_falls_on_planes_of_the_model) {
  RoomSetup room({.box_m = {0.5, 0.2, 3.2}});
  room.put_mirror();
  room.draw_background_for_each_pose();
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  frame.world_from_target.translation_m = {0.02, 0.01, 0};
  expect_agreement(pair, frame);
  EXPECT_GT(share_within(pair.gles_frame.mixed_depth_m, pair.cpu_frame.mixed_depth_m, 0.05), 0.99);
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kVirtual));
}

/// The lens zooms, shifts its pupil and changes its distortion from frame to frame, and comes back.
TEST(WholeFrame, agrees_through_a_lens_that_moves) {
  RoomSetup room({.view = {327, 245}, .lens_k1 = -0.08});
  room.draw_background_for_each_pose();
  room.setup.lens_moves = true;
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  expect_agreement(pair, frame);
  for (const double zoom : {1.6, 1.1, 1.0}) {
    frame.lens = geometry::LensState{room.setup.target, 0.03 * (zoom - 1)};
    geometry::Pinhole& p = frame.lens->camera.pinhole;
    p.fx_px *= zoom, p.fy_px *= zoom, p.cx_px += 2 * (zoom - 1);
    frame.lens->camera.lens = geometry::Lens({-0.08 + 0.1 * (zoom - 1), 0, 0, 0, 0, 0, 0, 0});
    expect_agreement(pair, frame);
    EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kVirtual));
  }
  EXPECT_GT(time_of(pair, render::Stage::kBackground), 0);
}

TEST(WholeFrame, agrees_with_a_background_model_of_several_faces) {
  RoomSetup room({.background = false});
  const FaceModel faces(room.scene);
  room.setup.background_models = {faces.model()};
  Pair pair = make_pair(room);
  expect_agreement_as_it_turns(pair, room.frame());
}

TEST(WholeFrame, agrees_with_background_models_of_several_places) {
  RoomSetup room({.background = false});
  const FaceModel left(room.scene, 2, {-0.3, 0, 0}), right(room.scene, 1, {0.3, 0.1, 0});
  room.setup.background_models = {left.model(), right.model()};
  for (const bool first_has_color : {true, false}) {
    if (!first_has_color) room.setup.background_models.front().color = {};
    Pair pair = make_pair(room);
    expect_agreement_as_it_turns(pair, room.frame());
  }
}

TEST(WholeFrame, agrees_with_a_background_model_without_color) {
  RoomSetup room({.background_color = false});
  room.draw_background_for_each_pose();
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  frame.world_from_target.translation_m = {0.02, 0.01, 0};
  expect_agreement(pair, frame);
}

}  // namespace
}  // namespace mixrig::test
