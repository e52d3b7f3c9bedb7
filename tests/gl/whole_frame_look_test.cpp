// SPDX-License-Identifier: Apache-2.0
// Both back ends apply the same look (grain, blur, chroma, sharpening) to a frame.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "host/render/frame/picture_look.h"
#include "tests/gl/whole_frame_pair.h"

namespace mixrig::test {
namespace {

/// Imitates a cheap camera along rows: luma is sharpened, chroma is the mean of five pixels.
Image<Rgb8> as_a_cheap_camera(const Image<Rgb8>& from) {
  Image<Rgb8> to = from;
  const auto grey = [](Rgb8 c) { return (c.r + c.g + c.b) / 3.0; };
  for (int y = 0; y < from.height(); ++y)
    for (int x = 2; x + 2 < from.width(); ++x) {
      const double light = grey(from.at(x, y));
      const double beside = grey(from.at(x - 1, y)) + grey(from.at(x + 1, y));
      const auto channel = [&](std::uint8_t Rgb8::*of) {
        double color = 0;
        for (int i = -2; i <= 2; ++i)
          color += (from.at(x + i, y).*of - grey(from.at(x + i, y))) / 5;
        const double v = light + 0.3 * (2 * light - beside) + color;
        return static_cast<std::uint8_t>(std::clamp(std::lround(v), 0L, 255L));
      };
      to.row(y)[x] = {channel(&Rgb8::r), channel(&Rgb8::g), channel(&Rgb8::b)};
    }
  return to;
}

TEST(WholeFrame, agrees_with_the_grain_and_blur_of_the_plate) {
  RoomSetup room(RoomSetup::Options{});
  Pair plain = make_pair(room);
  expect_agreement(plain, room.frame());
  room.setup.look = {.grain = true, .blur = true};
  Pair pair = make_pair(room);
  for (int i = 0; i < 3; ++i) expect_agreement(pair, room.frame());
  EXPECT_LT(psnr_db(pair.cpu_frame.color, plain.cpu_frame.color), 70);
  const Image<Rgb8> last = pair.cpu_frame.color;
  expect_agreement(pair, room.frame());
  EXPECT_LT(psnr_db(pair.cpu_frame.color, last), 90) << "the grain stands still";
  room.setup.people_cast_shadows = true;
  Pair past_people = make_pair(room);
  for (int i = 0; i < 2; ++i) expect_agreement(past_people, room.frame());
}

/// Without a look that the scene asks for, edges still are as wide as those of the plate.
TEST(WholeFrame, agrees_with_edges_of_the_plates_width) {
  for (const bool past_people : {false, true}) {
    RoomSetup room(RoomSetup::Options{});
    room.setup.people_cast_shadows = past_people;
    render::FrameInput frame = room.frame();
    render::PictureLook look;
    frame.look = &look;
    Pair sharp = make_pair(room);
    expect_agreement(sharp, frame);
    look.blur_px = 0.5F;
    Pair soft = make_pair(room);
    for (int i = 0; i < 2; ++i) expect_agreement(soft, frame);
    EXPECT_LT(psnr_db(soft.gles_frame.color, sharp.gles_frame.color), 60);
    EXPECT_GT(psnr_db(soft.cpu_frame.color, soft.gles_frame.color),
              psnr_db(soft.cpu_frame.color, sharp.cpu_frame.color) + 6);
  }
}

/// The look in a frame applies from that frame on, even if the first frame had none.
TEST(WholeFrame, agrees_with_a_look_that_changes) {
  RoomSetup room(RoomSetup::Options{});
  room.setup.look = {.grain = true, .blur = true, .chroma = true};
  for (const bool at_first : {false, true}) {
    Pair pair = make_pair(room);
    render::FrameInput frame = room.frame();
    render::PictureLook look{.grain = {.floor = glm::vec3(2e-5F), .slope = glm::vec3(1e-5F)}};
    if (at_first) frame.look = &look;
    expect_agreement(pair, frame);
    const Image<Rgb8> sharp = pair.cpu_frame.color;
    look.blur_px = 1, look.chroma_px = {0.8F, 0.4F}, look.grain.floor *= 20.0F;
    frame.look = &look;
    for (int i = 0; i < 2; ++i) expect_agreement(pair, frame);
    EXPECT_LT(psnr_db(pair.cpu_frame.color, sharp), 60);
    frame.look = nullptr;
    const Image<Rgb8> blurred = pair.cpu_frame.color;
    expect_agreement(pair, frame);
    EXPECT_GT(psnr_db(pair.cpu_frame.color, blurred), psnr_db(pair.cpu_frame.color, sharp))
        << "it stays as it is";
  }
}

TEST(WholeFrame, agrees_with_chroma_and_sharpening) {
  RoomSetup room(RoomSetup::Options{});
  room.plate = as_a_cheap_camera(room.plate);
  Pair plain = make_pair(room);
  expect_agreement(plain, room.frame());
  room.setup.look = {.chroma = true, .sharpening = true};
  Pair pair = make_pair(room);
  for (int i = 0; i < 2; ++i) expect_agreement(pair, room.frame());
  EXPECT_LT(psnr_db(pair.cpu_frame.color, plain.cpu_frame.color), 70) << "nothing was measured";
}

/// Motion blur is tested alone and together with the blur of the lens.
TEST(WholeFrame, agrees_in_the_motion_of_the_camera) {
  for (const bool blur : {false, true}) {
    RoomSetup room({.box_m = {0.1, 0.5, 2.4}});
    room.setup.look.blur = blur;
    Pair sharp = make_pair(room);
    room.setup.look.motion = true;
    Pair pair = make_pair(room);
    render::FrameInput frame = room.frame();
    expect_agreement(sharp, frame);
    expect_agreement(pair, frame);
    EXPECT_GT(psnr_db(pair.gles_frame.color, sharp.gles_frame.color), 98) << "no motion is known";
    for (const render::CameraMotion& motion :
         {render::CameraMotion{.turn_rad = {0.01F, 0.02F, 0.05F}},
          render::CameraMotion{.turn_rad = {0, 0.02F, 0}, .shift_m = {0.1F, 0, 0.1F}}}) {
      frame.motion = motion;
      expect_agreement(pair, frame);
      EXPECT_LT(psnr_db(pair.gles_frame.color, sharp.gles_frame.color), 45);
    }
    frame.motion.reset();
    expect_agreement(pair, frame);
    EXPECT_GT(psnr_db(pair.gles_frame.color, sharp.gles_frame.color), 98)
        << "it stands still again";
  }
}

/// The focus is first set by distance, then by a pixel that the frame names.
TEST(WholeFrame, agrees_in_the_depth_of_field_of_a_lens) {
  for (const bool fast : {false, true}) {
    RoomSetup room(RoomSetup::Options{});
    render::Focus& focus = room.setup.focus.emplace();
    focus.distance_m = 1.5F, focus.aperture_m = 0.2F, focus.most_blur_px = 24, focus.fast = fast;
    Pair pair = make_pair(room);
    render::FrameInput frame = room.frame();
    expect_agreement(pair, frame);
    EXPECT_GT(time_of(pair, render::Stage::kFocus), 0);
    const Image<Rgb8> near = pair.gles_frame.color;
    RoomSetup without(RoomSetup::Options{});
    Pair sharp = make_pair(without);
    expect_agreement(sharp, frame);
    EXPECT_LT(psnr_db(near, sharp.gles_frame.color), 35) << "there is blur";
    frame.focus_pixel = glm::ivec2(3, 3);
    expect_agreement(pair, frame);
    EXPECT_LT(psnr_db(near, pair.gles_frame.color), 40) << "another plane is sharp";
  }
}

TEST(WholeFrame, refuses_to_focus_outside_the_view) {
  RoomSetup room(RoomSetup::Options{});
  room.setup.focus.emplace().distance_m = 1.5F;
  room.setup.focus->aperture_m = 0.02F;
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  frame.focus_pixel = glm::ivec2(-1, 3);
  for (render::Compositor* c : {pair.cpu.get(), pair.gles.get()}) {
    const auto refused = c->compose(frame, pair.cpu_frame);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kData);
  }
}

}  // namespace
}  // namespace mixrig::test
