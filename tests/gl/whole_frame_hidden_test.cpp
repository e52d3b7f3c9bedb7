// SPDX-License-Identifier: Apache-2.0
// A frame that hides the objects equals, bit by bit, that of a setup without them; the set remains.
#include <gtest/gtest.h>

#include "host/render/contract/frame_io.h"
#include "tests/gl/whole_frame_pair.h"

namespace mixrig::test {
namespace {

constexpr Size kSmallView{160, 120}, kSmallTof{64, 48};

template <typename T>
bool is_same(const Image<T>& a, const Image<T>& b) {
  bool same = a.size() == b.size();
  for (int y = 0; same && y < a.height(); ++y)
    for (int x = 0; same && x < a.width(); ++x) same = a.at(x, y) == b.at(x, y);
  return same;
}

/// Expects that all images of both back ends are the same.
void expect_same(const Pair& a, const Pair& b, const char* when) {
  const auto compare = [&](const char* back_end) {
    return [=](render::OutputMask bit, auto& of_a, auto& of_b) {
      EXPECT_FALSE(of_a.size().area() == 0);
      EXPECT_TRUE(is_same(of_a, of_b)) << when << ": " << back_end << ", image " << bit;
    };
  };
  render::for_each_image(a.cpu_frame, b.cpu_frame, compare("cpu"));
  render::for_each_image(a.gles_frame, b.gles_frame, compare("gles"));
}

void compose(Pair& pair, const render::FrameInput& frame) {
  ASSERT_TRUE(pair.cpu && pair.gles);
  const auto first = pair.cpu->compose(frame, pair.cpu_frame);
  const auto second = pair.gles->compose(frame, pair.gles_frame);
  ASSERT_TRUE(first) << first.error().context;
  ASSERT_TRUE(second) << second.error().context;
}

/// Compares frames of a compositor that hides the objects now and then with those of one that never
/// has them and of one that never hides them.
void expect_hidden_as_without(RoomSetup& room, render::FrameInput frame) {
  room.setup.may_hide_objects = true;
  Pair pair = make_pair(room), always = make_pair(room);
  std::erase_if(room.setup.objects, [](const auto& object) { return !object.in_set; });
  room.setup.may_hide_objects = false;
  Pair without = make_pair(room);
  render::FrameInput hiding = frame;
  hiding.objects_shown = false;
  const auto expect_hidden = [&](const char* when) {
    compose(pair, hiding);
    render::FrameInput same = hiding;
    same.objects_shown = true;
    compose(without, same);
    expect_same(pair, without, when);
  };
  const auto expect_shown = [&](const char* when, const render::FrameInput& without_hiding) {
    compose(pair, frame);
    compose(always, without_hiding);
    expect_same(pair, always, when);
    EXPECT_FALSE(is_same(pair.cpu_frame.color, without.cpu_frame.color)) << when;
  };
  expect_hidden("first frame");
  expect_shown("shown, first", frame);
  expect_hidden("hidden again, at the same pose");
  expect_hidden("hidden on, at the same pose");
  expect_shown("shown again, at the same pose", frame);
  frame.world_from_target.translation_m += Eigen::Vector3d(0.02, 0.01, 0);
  hiding.world_from_target = frame.world_from_target;
  expect_hidden("hidden, at another pose");
  expect_shown("shown, at another pose", frame);
  render::FrameLight light{render::to_glm(room.setup.light.ambient), 1.2F, {}};
  hiding.light = frame.light = light;
  expect_hidden("hidden, in another light");
  const render::FrameInput lit = frame;
  hiding.light.reset(), frame.light.reset();
  expect_shown("shown, in the light of a frame that hid the objects", lit);
}

/// Makes the room's box the set, and adds a smaller box beside it as the object.
void add_object_to_set(RoomSetup& room) {
  room.setup.objects[0].in_set = true;
  render::VirtualObject object = room.setup.objects[0];
  object.in_set = false, object.scale = 0.5;
  object.world_from_object.translation_m += Eigen::Vector3d(0.1, -0.3, 0.2);
  object.meshes[0].gloss = {.metallic = 0.3F, .roughness = 0.4F, .specular = 1};
  room.setup.objects.insert(room.setup.objects.begin(), object);
}

TEST(HiddenObjects, leave_a_still_camera_s_frame_as_without_them) {
  RoomSetup room({kSmallView, kSmallTof});
  room.put_mirror();
  room.setup.people_cast_shadows = true;
  expect_hidden_as_without(room, room.frame());
}

TEST(HiddenObjects, leave_a_moving_camera_s_frame_as_without_them) {
  RoomSetup room({kSmallView, kSmallTof});
  room.put_mirror();
  room.draw_background_for_each_pose();
  room.setup.light.contact = true;
  expect_hidden_as_without(room, room.frame());
}

TEST(HiddenObjects, leave_the_set) {
  RoomSetup room({.view = kSmallView, .tof = kSmallTof, .box_m = {0.4, 0.9, 3.2}});
  add_object_to_set(room);
  const render::FrameInput frame = volume_frame(room);
  room.setup.backdrop.emplace();
  room.setup.people_cast_shadows = true;
  room.setup.look = {.grain = true, .blur = true};
  expect_hidden_as_without(room, frame);
}

TEST(HiddenObjects, leave_the_set_before_a_room_that_is_drawn_for_each_pose) {
  RoomSetup room({kSmallView, kSmallTof});
  add_object_to_set(room);
  room.draw_background_for_each_pose();
  room.setup.backdrop.emplace();
  expect_hidden_as_without(room, room.frame());
}

TEST(HiddenObjects, are_one_line_where_the_compositor_always_shows_them) {
  RoomSetup room({kSmallView, kSmallTof});
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  frame.objects_shown = false;
  for (render::Compositor* compositor : {pair.cpu.get(), pair.gles.get()}) {
    const auto result = compositor->compose(frame, pair.cpu_frame);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kUsage);
  }
}

}  // namespace
}  // namespace mixrig::test
