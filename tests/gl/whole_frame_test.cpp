// SPDX-License-Identifier: Apache-2.0
// Both back ends draw the same frame.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/gl/whole_frame_pair.h"

namespace mixrig::test {
namespace {

/// Moves the content of a picture to the right; the border column fills the gap.
template <typename T>
Image<T> moved_right(const Image<T>& from, int px) {
  Image<T> to(from.size());
  for (int y = 0; y < to.height(); ++y)
    for (int x = 0; x < to.width(); ++x) to.at(x, y) = from.at(std::max(0, x - px), y);
  return to;
}

/// Depth moves while the plate stays, so that both back ends blend in the matte before.
TEST(WholeFrame, agrees_where_the_matte_before_joins) {
  const RoomSetup room(RoomSetup::Options{});
  Pair pair = make_pair(room), alone = make_pair(room);
  render::FrameInput frame = room.frame();
  frame.time_s = 1;
  expect_agreement(pair, frame);
  const Image<float> depth = moved_right(room.depth, 2);
  frame.tof_depth_m = depth, frame.time_s = 1.04;
  expect_agreement(pair, frame);
  expect_agreement(alone, frame);
  EXPECT_LT(share_within(pair.gles_frame.matte, alone.gles_frame.matte, 2), 0.9995)
      << "the matte before changes it";
}

/// The object must be right in the frame in which it moves and after it: virtual pixels, shadow
/// maps and the light they change.
TEST(WholeFrame, draws_a_moved_object_as_one_that_stood_there) {
  RoomSetup room(RoomSetup::Options{}), there(RoomSetup::Options{});
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  expect_agreement(pair, frame);
  const Image<Rgb8> before = pair.cpu_frame.color;
  std::vector<geometry::Pose> poses;
  for (const render::VirtualObject& object : room.setup.objects)
    poses.push_back(object.world_from_object);
  ASSERT_FALSE(poses.empty());
  poses[0].translation_m += Eigen::Vector3d(0.12, 0, 0.08);
  frame.world_from_object = poses;
  there.setup.objects[0].world_from_object = poses[0];
  Pair still = make_pair(there);
  expect_agreement(still, there.frame());
  for (int i = 0; i < 2; ++i) {
    expect_agreement(pair, frame);
    EXPECT_LT(psnr_db(pair.cpu_frame.color, before), 40) << "it has moved";
    EXPECT_GE(psnr_db(pair.cpu_frame.color, still.cpu_frame.color), 60);
    EXPECT_GE(psnr_db(pair.gles_frame.color, still.gles_frame.color), 60);
  }
}

TEST(WholeFrame, agrees_through_a_lens_at_odd_sizes) {
  expect_agreement({.view = {327, 245}, .tof = {121, 87}, .lens_k1 = -0.12});
}

TEST(WholeFrame, agrees_with_two_depth_cameras) {
  RoomSetup room({.second_tof = true});
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  room.depth2 = {};  // a frame without the second camera's depth
  expect_agreement(pair, room.frame());
}

TEST(WholeFrame, agrees_without_background) { expect_agreement({.background = false}); }

TEST(WholeFrame, agrees_without_learned_color) { expect_agreement({.background_color = false}); }

TEST(WholeFrame, agrees_without_objects) { expect_agreement({.objects = false}); }

TEST(WholeFrame, agrees_without_lamps) { expect_agreement({.lamps = false}); }

TEST(WholeFrame, agrees_with_distances_and_a_capture_box) {
  RoomSetup room(RoomSetup::Options{});
  room.setup.depth_is_distance = true;
  for (int y = 0; y < room.depth.height(); ++y)
    for (int x = 0; x < room.depth.width(); ++x) {
      const auto ray = room.setup.tof.unproject({x, y});
      room.depth.at(x, y) *= static_cast<float>(std::sqrt(1 + ray->squaredNorm()));
    }
  room.setup.capture_box = render::CaptureBox{{-5, -0.4, 0}, {5, 5, 9}};  // cuts off the head
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
}

TEST(WholeFrame, follows_the_camera_and_comes_back) {
  const RoomSetup room(RoomSetup::Options{});
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  const Image<Rgb8> first = pair.gles_frame.color;
  render::FrameInput moved = room.frame();
  moved.world_from_target.translation_m = {0.2, -0.1, 0.3};
  expect_agreement(pair, moved);
  EXPECT_LT(psnr_db(first, pair.gles_frame.color), 40);  // the object moved in the picture
  expect_agreement(pair, room.frame());
  EXPECT_EQ(psnr_db(first, pair.gles_frame.color), 99);
}

TEST(WholeFrame, object_out_of_sight_leaves_nothing_behind) {
  const RoomSetup room(RoomSetup::Options{});
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  render::FrameInput away = room.frame();
  away.world_from_target.translation_m = {0, 0, 10};
  expect_agreement(pair, away);
  EXPECT_FALSE(shows(pair.gles_frame, render::Layer::kVirtual));
}

TEST(WholeFrame, draws_only_what_the_scene_needs) {
  const RoomSetup room({}), bare({.objects = false});
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  EXPECT_GT(time_of(pair, render::Stage::kVirtual), 0);
  EXPECT_GT(time_of(pair, render::Stage::kShadow), 0);
  EXPECT_EQ(time_of(pair, render::Stage::kPlate), 0);  // no lens: nothing to resample
  expect_agreement(pair, room.frame());                // the camera stands still
  EXPECT_EQ(time_of(pair, render::Stage::kVirtual), 0);
  EXPECT_EQ(time_of(pair, render::Stage::kShadow), 0);
  Pair without = make_pair(bare);
  expect_agreement(without, bare.frame());
  EXPECT_EQ(time_of(without, render::Stage::kVirtual), 0);
  EXPECT_EQ(time_of(without, render::Stage::kLight), 0);
  EXPECT_GT(time_of(without, render::Stage::kWarp), 0);
}

TEST(WholeFrame, bad_pictures_are_one_line_and_change_nothing) {
  RoomSetup room(RoomSetup::Options{});
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  const Image<Rgb8> before = pair.gles_frame.color;
  const Image<float> wrong({3, 3});
  render::FrameInput frame = room.frame();
  frame.tof_depth_m = wrong;
  const auto result = pair.gles->compose(frame, pair.gles_frame);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kData);
  EXPECT_EQ(psnr_db(before, pair.gles_frame.color), 99);
  room.depth.fill(std::numeric_limits<float>::quiet_NaN());  // a camera that sees nothing
  expect_agreement(pair, room.frame());
  EXPECT_FALSE(shows(pair.gles_frame, render::Layer::kPerson));
}

}  // namespace
}  // namespace mixrig::test
