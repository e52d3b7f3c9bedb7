// SPDX-License-Identifier: Apache-2.0
// A mirror whose depth has wrapped around, beside objects that hang or stand in a room.
#include "host/render/tables/wrapped_areas.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/render/tables/room_mesh.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kMirrorView{160, 128};
constexpr float kMirrorTooNearM = 2.5F;

float wall_m(int x) { return 1 / (0.25F - 0.0004F * static_cast<float>(x)); }

/// A slanted wall, and a rectangle before it.
struct MirrorRoom {
  MirrorRoom(int x0, int y0, int x1, int y1, float spread)
      : inside([=](int x, int y) { return x >= x0 && x < x1 && y >= y0 && y < y1; }),
        depth_m(make_image<float>(
            kMirrorView, [&](int x, int y) { return inside(x, y) ? kMirrorTooNearM : wall_m(x); })),
        sigma_m(make_image<float>(kMirrorView, [&](int x, int y) {
          const float z = depth_m.at(x, y);
          return 0.001F * z * z * (inside(x, y) ? spread : 1);
        })) {}
  std::function<bool(int, int)> inside;
  Image<float> depth_m, sigma_m;
};

/// Largest part by which depth is off the wall.
float off_wall(const Image<float>& depth_m) {
  float most = 0;
  for (int y = 0; y < depth_m.height(); ++y)
    for (int x = 0; x < depth_m.width(); ++x)
      most = std::max(most, std::abs(depth_m.at(x, y) / wall_m(x) - 1));
  return most;
}

TEST(WrappedAreas, a_mirror_lies_in_the_wall_around_it) {
  MirrorRoom room(40, 30, 90, 80, 10);
  for (int y = 30; y < 80; ++y) room.depth_m.at(39, y) = 0;  // its border measured nothing
  Image<float> found = render::without_wrapped(room.depth_m, room.sigma_m);
  for (int y = 30; y < 80; ++y) {
    EXPECT_EQ(found.at(39, y), 0);
    found.at(39, y) = wall_m(39);
  }
  EXPECT_LT(off_wall(found), 1e-3F);
}

TEST(WrappedAreas, what_stands_before_a_mirror_stays) {
  MirrorRoom room(40, 30, 90, 80, 10);
  for (int y = 50; y < 128; ++y)
    for (int x = 60; x < 66; ++x) {
      room.depth_m.at(x, y) = 3;
      room.sigma_m.at(x, y) = 0.009F;
    }
  const Image<float> found = render::without_wrapped(room.depth_m, room.sigma_m);
  EXPECT_EQ(found.at(63, 60), 3);
  EXPECT_NEAR(found.at(50, 60), wall_m(50), 0.01F);
  EXPECT_NEAR(found.at(80, 60), wall_m(80), 0.01F);
}

TEST(WrappedAreas, what_hangs_with_the_noise_of_the_room_stays) {
  const MirrorRoom room(40, 30, 90, 80, 3);
  EXPECT_EQ(render::without_wrapped(room.depth_m, room.sigma_m).at(60, 60), kMirrorTooNearM);
}

TEST(WrappedAreas, what_reaches_the_border_of_the_picture_stays) {
  const MirrorRoom room(40, 30, 90, 128, 10);
  EXPECT_EQ(render::without_wrapped(room.depth_m, room.sigma_m).at(60, 60), kMirrorTooNearM);
}

TEST(WrappedAreas, nothing_changes_without_spread) {
  const MirrorRoom room(40, 30, 90, 80, 10);
  EXPECT_EQ(render::without_wrapped(room.depth_m, {}).at(60, 60), kMirrorTooNearM);
}

/// A room with colours and a block that is lit, for all that asks for the learned depth.
render::CompositorSetup setup_of(const MirrorRoom& room, const Image<Rgbf>& color) {
  render::CompositorSetup setup = plain_setup(kMirrorView, 150, {80, 64}, 75);
  setup.background = {room.depth_m, room.sigma_m, color, {}};
  setup.objects.emplace_back();
  return setup;
}

TEST(WrappedAreas, mix_and_light_see_the_wall_and_the_key_what_was_learned) {
  const MirrorRoom room(40, 30, 90, 80, 10);
  const Image<Rgbf> color(kMirrorView, {0.4F, 0.4F, 0.4F});
  const render::Tables tables = render::make_tables(setup_of(room, color));
  EXPECT_LT(off_wall(tables.edge_depth_m), 1e-3F);
  EXPECT_GT(tables.key_limit_w.at(60, 60), 0.9F / kMirrorTooNearM);
}

void expect_mesh_on_the_wall(const render::CompositorSetup& setup) {
  const auto mesh = render::make_room_mesh(setup, {});
  EXPECT_EQ(mesh.positions_m.size(), 160U * 128U);
  for (const glm::vec3& p : mesh.positions_m) EXPECT_GT(p.z, 3.9F);
}

TEST(WrappedAreas, a_mirror_hides_no_lamp) {
  const MirrorRoom room(40, 30, 90, 80, 10);
  const Image<Rgbf> color(kMirrorView, {0.4F, 0.4F, 0.4F});
  render::CompositorSetup setup = setup_of(room, color);
  expect_mesh_on_the_wall(setup);
  setup.background = {};
  render::BackgroundModel model;
  model.camera = setup.view;
  model.world_from_face.emplace_back();
  model.depth_m = room.depth_m, model.depth_sigma_m = room.sigma_m;
  setup.background_models.push_back(model);
  expect_mesh_on_the_wall(setup);
}

}  // namespace
}  // namespace mixrig::test
