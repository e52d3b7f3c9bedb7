// SPDX-License-Identifier: Apache-2.0
// Both back ends draw the same frame.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/render/cpu/compositor_cpu.h"
#include "host/render/gles/compositor_gles.h"
#include "host/render/picture_look.h"
#include "host/render/room_shade.h"
#include "tests/gl/gl_fixture.h"
#include "tests/gl/room_setup.h"
#include "tests/support/face_model.h"

namespace mixrig::test {
namespace {

using render::FrameOutput;

double psnr_db(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const Rgb8 p = a.at(x, y), q = b.at(x, y);
      sum += std::pow(p.r - q.r, 2) + std::pow(p.g - q.g, 2) + std::pow(p.b - q.b, 2);
    }
  const double mean = sum / (3.0 * static_cast<double>(a.size().area()));
  return mean > 0 ? 10 * std::log10(255 * 255 / mean) : 99;
}

/// Share of pixels whose values lie within `tolerance`.
template <typename T>
double share_within(const Image<T>& a, const Image<T>& b, double tolerance) {
  std::size_t good = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      good +=
          std::abs(static_cast<double>(a.at(x, y)) - static_cast<double>(b.at(x, y))) <= tolerance;
  return static_cast<double>(good) / static_cast<double>(a.size().area());
}

struct Pair {
  std::unique_ptr<render::Compositor> cpu, gles;
  FrameOutput cpu_frame, gles_frame;
};

Pair make_pair(const RoomSetup& room) {
  Pair pair;
  auto cpu = render::make_cpu_compositor(room.setup, 2);
  auto gles = render::make_gles_compositor(room.setup);
  EXPECT_TRUE(cpu) << cpu.error().context;
  EXPECT_TRUE(gles) << gles.error().context;
  if (cpu && gles) pair.cpu = std::move(*cpu), pair.gles = std::move(*gles);
  pair.cpu_frame.wanted = pair.gles_frame.wanted = render::kAll;
  return pair;
}

/// Both draw the frame, and what they draw agrees.
void expect_agreement(Pair& pair, const render::FrameInput& frame) {
  ASSERT_TRUE(pair.cpu && pair.gles);
  const auto first = pair.cpu->compose(frame, pair.cpu_frame);
  const auto second = pair.gles->compose(frame, pair.gles_frame);
  ASSERT_TRUE(first) << first.error().context;
  ASSERT_TRUE(second) << second.error().context;
  const FrameOutput &cpu = pair.cpu_frame, &gles = pair.gles_frame;
  EXPECT_GE(psnr_db(cpu.color, gles.color), 45);
  EXPECT_GE(share_within(cpu.warped_depth_m, gles.warped_depth_m, 0.002), 0.995);
  EXPECT_GE(share_within(cpu.mixed_depth_m, gles.mixed_depth_m, 0.002), 0.995);
  EXPECT_GE(share_within(cpu.segmented_depth_m, gles.segmented_depth_m, 0.002), 0.995);
  EXPECT_GE(share_within(cpu.matte, gles.matte, 8), 0.995);
  EXPECT_GE(share_within(cpu.state, gles.state, 0), 0.995);
  EXPECT_GE(share_within(cpu.light, gles.light, 0.02), 0.995);
  EXPECT_GE(share_within(cpu.layer, gles.layer, 0), 0.998);
  EXPECT_GE(share_within(cpu.alpha, gles.alpha, 8), 0.995);
  testing::Test::RecordProperty("psnr_db", std::to_string(psnr_db(cpu.color, gles.color)));
}

void expect_agreement(const RoomSetup::Options& options) {
  const RoomSetup room(options);
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
}

bool shows(const FrameOutput& frame, render::Layer layer) {
  for (int y = 0; y < frame.layer.height(); ++y)
    for (int x = 0; x < frame.layer.width(); ++x)
      if (frame.layer.at(x, y) == static_cast<std::uint8_t>(layer)) return true;
  return false;
}

float time_of(const Pair& pair, render::Stage stage) {
  return pair.gles->stage_times()[static_cast<std::size_t>(stage)];
}

/// The room's still background as a model that is drawn for each pose.
TEST(WholeFrame, agrees_with_a_background_model_at_every_pose) {
  RoomSetup room(RoomSetup::Options{});
  room.draw_background_for_each_pose();
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  expect_agreement(pair, frame);
  // The picture of the room stays: what is compared is what both make of it.
  frame.world_from_target.translation_m = {0.02, 0.01, 0};
  expect_agreement(pair, frame);
  frame.world_from_target.rotation =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()) * frame.world_from_target.rotation;
  expect_agreement(pair, frame);
}

/// A picture whose content has moved to the right; what comes in is its border.
template <typename T>
Image<T> moved_right(const Image<T>& from, int px) {
  Image<T> to(from.size());
  for (int y = 0; y < to.height(); ++y)
    for (int x = 0; x < to.width(); ++x) to.at(x, y) = from.at(std::max(0, x - px), y);
  return to;
}

/// All moves, so that both move people's depth and take what the matte was where they were.
TEST(WholeFrame, agrees_where_people_move_between_frames) {
  const RoomSetup room(RoomSetup::Options{});
  Pair pair = make_pair(room), late = make_pair(room);
  render::FrameInput frame = room.frame();
  frame.time_s = 1;
  expect_agreement(pair, frame);
  expect_agreement(late, frame);
  const Image<Rgb8> plate = moved_right(room.plate, 5);
  const Image<float> depth = moved_right(room.depth, 2);
  frame.plate = plate, frame.tof_depth_m = depth, frame.time_s = 1.04;
  expect_agreement(pair, frame);
  frame.depth_delay_s = -0.04;
  expect_agreement(late, frame);
  EXPECT_LT(share_within(pair.cpu_frame.segmented_depth_m, late.cpu_frame.segmented_depth_m, 0.002),
            0.998)
      << "late depth is moved";
}

/// In the frame in which it moves and after it: virtual pixels, shadow maps and what they fall on.
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

/// In the frame in which it changes and after it; a lamp that was turned off comes back.
TEST(WholeFrame, draws_by_a_changed_light_as_by_one_that_was_so) {
  RoomSetup room(RoomSetup::Options{}), there(RoomSetup::Options{});
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  expect_agreement(pair, frame);
  const Image<Rgb8> before = pair.cpu_frame.color;
  ASSERT_FALSE(room.setup.light.lamps.empty());
  std::vector<glm::vec3> intensity;
  for (const render::Lamp& lamp : room.setup.light.lamps)
    intensity.push_back(0.2F * lamp.intensity);
  const std::vector<glm::vec3> dark(intensity.size(), glm::vec3(0));
  frame.light = render::FrameLight{{0.5F, 0.4F, 0.3F}, 0.8F, dark};
  expect_agreement(pair, frame);
  frame.light->intensity = intensity;
  there.setup.light.ambient = frame.light->ambient, there.setup.light.exposure = 0.8F;
  for (std::size_t i = 0; i < intensity.size(); ++i)
    there.setup.light.lamps[i].intensity = intensity[i];
  Pair still = make_pair(there);
  expect_agreement(still, there.frame());
  for (int i = 0; i < 2; ++i) {
    expect_agreement(pair, frame);
    EXPECT_LT(psnr_db(pair.cpu_frame.color, before), 45) << "it has changed";
    EXPECT_GE(psnr_db(pair.cpu_frame.color, still.cpu_frame.color), 60);
    EXPECT_GE(psnr_db(pair.gles_frame.color, still.gles_frame.color), 60);
  }
}

/// World axes with z up, 1.4 m over the room's floor; only the capture volume keys.
render::FrameInput volume_frame(RoomSetup& room) {
  Eigen::Matrix3d axes;  // columns: right, down, forward
  axes.col(0) = -Eigen::Vector3d::UnitY();
  axes.col(1) = -Eigen::Vector3d::UnitZ();
  axes.col(2) = Eigen::Vector3d::UnitX();
  const geometry::Pose world_from_target{Eigen::Quaterniond(axes), {0, 0, room.scene.floor_y_m}};
  room.setup.background = {};
  room.setup.capture_box = render::CaptureBox{{1.5, -1.5, 0}, {3.5, 1.5, 2.4}};
  for (render::VirtualObject& object : room.setup.objects)
    object.world_from_object = world_from_target * object.world_from_object;
  for (render::Lamp& lamp : room.setup.light.lamps) {
    const Eigen::Vector3d p =
        world_from_target *
        Eigen::Vector3d(lamp.position_m.x, lamp.position_m.y, lamp.position_m.z);
    lamp.position_m = {p.x(), p.y(), p.z()};
    if (lamp.direction) lamp.direction = glm::dvec3(0, 0, -1);
  }
  render::FrameInput frame = room.frame();
  frame.world_from_target = world_from_target;
  return frame;
}

/// A lens that zooms, shifts its pupil and distorts otherwise from frame to frame, and comes back.
TEST(WholeFrame, agrees_through_a_lens_that_moves) {
  RoomSetup room({.view = {327, 245}, .lens_k1 = -0.08});
  room.draw_background_for_each_pose();
  room.setup.lens_moves = true;
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  expect_agreement(pair, frame);
  for (const double zoom : {1.6, 1.1, 1.0}) {
    frame.lens = render::FrameLens{room.setup.target, 0.03 * (zoom - 1)};
    geometry::Pinhole& p = frame.lens->target.pinhole;
    p.fx_px *= zoom, p.fy_px *= zoom, p.cx_px += 2 * (zoom - 1);
    frame.lens->target.lens = geometry::Lens({-0.08 + 0.1 * (zoom - 1), 0, 0, 0, 0, 0, 0, 0});
    expect_agreement(pair, frame);
    EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kVirtual));
  }
  EXPECT_GT(time_of(pair, render::Stage::kBackground), 0);
}

/// The same where the capture volume keys and people cast shadows on a set.
TEST(WholeFrame, agrees_through_a_lens_that_moves_on_a_set) {
  RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
  render::FrameInput frame = volume_frame(room);
  room.setup.backdrop.emplace();
  room.setup.people_cast_shadows = true;
  room.setup.lens_moves = true;
  Pair pair = make_pair(room);
  expect_agreement(pair, frame);
  frame.lens = render::FrameLens{room.setup.target, 0.01};
  frame.lens->target.pinhole.fx_px *= 1.4, frame.lens->target.pinhole.fy_px *= 1.4;
  expect_agreement(pair, frame);
}

/// At rest and turned aside, with the person in view.
void expect_agreement_as_it_turns(Pair& pair, render::FrameInput frame) {
  expect_agreement(pair, frame);
  frame.world_from_target.translation_m = {0.02, 0.01, 0};
  frame.world_from_target.rotation = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY());
  expect_agreement(pair, frame);
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kPerson));
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

TEST(WholeFrame, agrees_with_person_object_and_shadows) {
  const RoomSetup room(RoomSetup::Options{});
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kPerson));
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kVirtual));
}

/// All that a material may have, under ambient light that differs from side to side.
TEST(WholeFrame, agrees_on_glossy_objects_with_maps) {
  RoomSetup room(RoomSetup::Options{});
  room.setup.light.by_direction = room.setup.light.contact = true;
  const auto gloss_map = make_image<Rgb8>({8, 8}, [](int x, int y) {
    return Rgb8{0, static_cast<std::uint8_t>(120 + 16 * x),
                static_cast<std::uint8_t>(y < 4 ? 0 : 255)};
  });
  const auto normal_map = make_image<Rgb8>({8, 8}, [](int x, int y) {
    return Rgb8{static_cast<std::uint8_t>(98 + 8 * x), static_cast<std::uint8_t>(98 + 8 * y), 240};
  });
  const auto glow = make_image<Rgb8>({8, 8}, [](int x, int y) {
    return x == 2 && y == 2 ? Rgb8{250, 120, 20} : Rgb8{};
  });
  render::FrameOutput matte;
  {
    Pair pair = make_pair(room);
    expect_agreement(pair, room.frame());
    matte.color = pair.cpu_frame.color;
  }
  render::MeshView& mesh = room.setup.objects.front().meshes.front();
  mesh.gloss = {1, 0.7F, 1}, mesh.gloss_map = gloss_map, mesh.normal_map = normal_map;
  mesh.emission = glm::vec3(0.5F), mesh.emission_map = glow, mesh.normal_scale = 0.8F;
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  EXPECT_LT(psnr_db(pair.cpu_frame.color, matte.color), 40) << "gloss and maps change nothing";
}

TEST(WholeFrame, agrees_on_glossy_objects_past_people) {
  RoomSetup room(RoomSetup::Options{});
  room.setup.people_cast_shadows = true;
  room.setup.light.by_direction = room.setup.light.contact = true;
  room.setup.objects.front().meshes.front().gloss = {0.3F, 0.3F, 1};
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
}

TEST(WholeFrame, agrees_through_a_lens_at_odd_sizes) {
  expect_agreement({.view = {327, 245}, .tof = {121, 87}, .lens_k1 = -0.12});
}

TEST(WholeFrame, agrees_with_two_depth_cameras) {
  RoomSetup room({.second_tof = true});
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  room.depth2 = {};  // a frame without the second one
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

/// A real board over the object hides a lamp from it.
TEST(WholeFrame, agrees_in_the_shade_of_the_room) {
  RoomSetup room(RoomSetup::Options{});
  room.put_board({0.1, 0.25, 2.6}, 0.4);
  EXPECT_GT(render::make_room_shade(room.setup, {}).layers, 0);
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  room.draw_background_for_each_pose();
  Pair moving = make_pair(room);
  expect_agreement_as_it_turns(moving, room.frame());
}

TEST(WholeFrame, agrees_where_people_cast_shadows_on_an_object_in_the_room) {
  RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
  room.setup.people_cast_shadows = true;
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
}

/// A person between a lamp and the floor: the object's shadow there is that of the other lamp
/// alone.
TEST(WholeFrame, agrees_where_a_person_shades_the_floor) {
  RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
  Pair without = make_pair(room);
  expect_agreement(without, room.frame());
  room.setup.people_cast_shadows = true;
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  EXPECT_LT(share_within(pair.cpu_frame.light, without.cpu_frame.light, 0.01), 0.999)
      << "nothing of the object's shadow is in that of the person";
  room.draw_background_for_each_pose();
  Pair moving = make_pair(room);
  expect_agreement_as_it_turns(moving, room.frame());
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

/// What a frame says of the plate counts from it on, also where the first one said nothing.
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

TEST(WholeFrame, agrees_with_grain_and_blur_on_a_set) {
  RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
  const render::FrameInput frame = volume_frame(room);
  room.setup.backdrop.emplace();
  room.setup.look = {.grain = true, .blur = true};
  Pair pair = make_pair(room);
  for (int i = 0; i < 2; ++i) expect_agreement(pair, frame);
}

/// Along rows: brightness is sharpened, colour is the mean of five pixels.
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

/// Alone, and of what the lens has blurred, before a plate of its own.
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

/// By distance, by pixel, by a pixel that the frame names; in the last frame what is far is sharp.
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

TEST(WholeFrame, agrees_with_open_walls) {
  RoomSetup room({.box_m = {0.3, 0.4, 6.0}});  // behind the back wall
  room.setup.open_walls = true;
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kVirtual));
}

TEST(WholeFrame, agrees_when_the_camera_brightens_by_itself) {
  RoomSetup room(RoomSetup::Options{});
  for (int y = 0; y < room.plate.height(); ++y)
    for (int x = 0; x < room.plate.width(); ++x)
      room.plate.at(x, y).r = static_cast<std::uint8_t>(room.plate.at(x, y).r * 0.9);
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

TEST(WholeFrame, more_lamps_than_a_uniform_block_holds_is_an_error) {
  RoomSetup room(RoomSetup::Options{});
  room.setup.light.lamps.resize(33, room.setup.light.lamps[0]);
  const auto made = render::make_gles_compositor(room.setup);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(made.error().context.find("32"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::test
