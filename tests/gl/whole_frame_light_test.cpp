// SPDX-License-Identifier: Apache-2.0
// Both back ends light a frame the same way.
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/render/gles/compositor_gles.h"
#include "host/render/tables/room_shade.h"
#include "tests/gl/gl_fixture.h"
#include "tests/gl/whole_frame_pair.h"

namespace mixrig::test {
namespace {

/// The light must be right in the frame in which it changes and after it; a lamp that was turned
/// off comes back.
TEST(WholeFrame, draws_by_a_changed_light_as_by_one_that_was_so) {
  RoomSetup room(RoomSetup::Options{}), there(RoomSetup::Options{});
  Pair pair = make_pair(room);
  render::FrameInput frame = room.frame();
  expect_agreement(pair, frame);
  const Image<Rgb8> before = pair.cpu_frame.color;
  ASSERT_FALSE(room.setup.light.lamps.empty());
  std::vector<glm::vec3> intensity;
  for (const geometry::Lamp& lamp : room.setup.light.lamps)
    intensity.push_back(0.2F * render::to_glm(lamp.intensity));
  const std::vector<glm::vec3> dark(intensity.size(), glm::vec3(0));
  frame.light = render::FrameLight{{0.5F, 0.4F, 0.3F}, 0.8F, dark};
  expect_agreement(pair, frame);
  frame.light->intensity = intensity;
  there.setup.light.ambient = render::to_eigen(frame.light->ambient);
  there.setup.light.exposure = 0.8F;
  for (std::size_t i = 0; i < intensity.size(); ++i)
    there.setup.light.lamps[i].intensity = render::to_eigen(intensity[i]);
  Pair still = make_pair(there);
  expect_agreement(still, there.frame());
  for (int i = 0; i < 2; ++i) {
    expect_agreement(pair, frame);
    EXPECT_LT(psnr_db(pair.cpu_frame.color, before), 45) << "it has changed";
    EXPECT_GE(psnr_db(pair.cpu_frame.color, still.cpu_frame.color), 60);
    EXPECT_GE(psnr_db(pair.gles_frame.color, still.gles_frame.color), 60);
  }
}

TEST(WholeFrame, agrees_with_person_object_and_shadows) {
  const RoomSetup room(RoomSetup::Options{});
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kPerson));
  EXPECT_TRUE(shows(pair.gles_frame, render::Layer::kVirtual));
}

/// The material has all properties, under ambient light that depends on direction.
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

/// A real board above the object hides a lamp from it.
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

/// For panel lamps, cpu computes what people hide at the points of a grid, and between the corners
/// of cells; gles computes it for each pixel.
TEST(WholeFrame, agrees_where_people_stand_before_panels) {
  for (const double side_m : {0.6, 0.8}) {
    RoomSetup room({.box_m = {0.4, 0.9, 3.2}});
    for (geometry::Lamp& lamp : room.setup.light.lamps) {
      lamp.size_m = {side_m, side_m};
      lamp.direction = (Eigen::Vector3d(0.4, 0.9, 3.2) - lamp.position_m).normalized();
    }
    Pair without = make_pair(room);
    expect_agreement(without, room.frame());
    room.setup.people_cast_shadows = true;
    Pair pair = make_pair(room);
    expect_agreement(pair, room.frame());
    EXPECT_LT(psnr_db(pair.cpu_frame.color, without.cpu_frame.color), 50) << "nobody casts any";
  }
}

/// A person stands between a lamp and the floor: the object's shadow there is that of the other
/// lamp alone.
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

TEST(WholeFrame, agrees_when_the_camera_brightens_by_itself) {
  RoomSetup room(RoomSetup::Options{});
  for (int y = 0; y < room.plate.height(); ++y)
    for (int x = 0; x < room.plate.width(); ++x)
      room.plate.at(x, y).r = static_cast<std::uint8_t>(room.plate.at(x, y).r * 0.9);
  Pair pair = make_pair(room);
  expect_agreement(pair, room.frame());
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
