// SPDX-License-Identifier: Apache-2.0
// Both back ends draw the same set in place of the room.
#include <gtest/gtest.h>

#include "tests/gl/whole_frame_pair.h"

namespace mixrig::test {
namespace {

/// The lens moves, the capture volume keys, and people cast shadows on a set.
TEST(WholeFrame, agrees_through_a_lens_that_moves_on_a_set) {
  RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
  render::FrameInput frame = volume_frame(room);
  room.setup.backdrop.emplace();
  room.setup.people_cast_shadows = true;
  room.setup.lens_moves = true;
  Pair pair = make_pair(room);
  expect_agreement(pair, frame);
  frame.lens = geometry::LensState{room.setup.target, 0.01};
  frame.lens->camera.pinhole.fx_px *= 1.4, frame.lens->camera.pinhole.fy_px *= 1.4;
  expect_agreement(pair, frame);
}

TEST(WholeFrame, agrees_where_the_capture_volume_alone_keys) {
  RoomSetup room(RoomSetup::Options{});
  const render::FrameInput frame = volume_frame(room);
  Pair pair = make_pair(room);
  expect_agreement(pair, frame);
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kPerson));
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kVirtual));
}

TEST(WholeFrame, agrees_over_nothing_and_over_a_picture) {
  for (const bool with_picture : {false, true}) {
    RoomSetup room(RoomSetup::Options{});
    const render::FrameInput frame = volume_frame(room);
    const Image<Rgb8> picture(room.setup.view.size_px, {40, 150, 90});
    room.setup.backdrop.emplace();
    if (with_picture) room.setup.backdrop->picture = picture;
    Pair pair = make_pair(room);
    expect_agreement(pair, frame);
    EXPECT_EQ(pair.gles_frame.alpha.at(2, 2), with_picture ? 255 : 0);
    const Rgb8 expected = with_picture ? Rgb8{40, 150, 90} : Rgb8{0, 0, 0};
    EXPECT_EQ(pair.gles_frame.color.at(2, 2), expected);
  }
}

TEST(WholeFrame, agrees_over_nothing_where_the_room_was_learned) {
  RoomSetup room(RoomSetup::Options{});
  room.setup.backdrop.emplace();
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
}

TEST(WholeFrame, agrees_where_people_cast_shadows_on_a_set) {
  RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
  const render::FrameInput frame = volume_frame(room);
  room.setup.backdrop.emplace();
  room.setup.people_cast_shadows = true;
  Pair pair = make_pair(room);
  expect_agreement(pair, frame);
  const Image<Rgb8> shadowed = pair.cpu_frame.color;
  room.setup.people_cast_shadows = false;
  Pair without = make_pair(room);
  expect_agreement(without, frame);
  EXPECT_LT(psnr_db(shadowed, without.cpu_frame.color), 60);  // there is a shadow
}

TEST(WholeFrame, agrees_with_grain_and_blur_on_a_set) {
  RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
  const render::FrameInput frame = volume_frame(room);
  room.setup.backdrop.emplace();
  room.setup.look = {.grain = true, .blur = true};
  Pair pair = make_pair(room);
  for (int i = 0; i < 2; ++i) expect_agreement(pair, frame);
}

TEST(WholeFrame, agrees_with_open_walls) {
  RoomSetup room({.box_m = {0.3, 0.4, 6.0}});  // behind the back wall
  room.setup.open_walls = true;
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kVirtual));
}

}  // namespace
}  // namespace mixrig::test
