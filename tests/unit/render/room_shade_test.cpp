// SPDX-License-Identifier: Apache-2.0
// Occlusion of lamps by a real table, compared with closed forms.
#include "host/render/tables/room_shade.h"

#include <algorithm>
#include <cmath>

#include "host/render/cpu/compositor_cpu.h"
#include "host/render/tables/prepare.h"
#include "tests/support/psnr.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kRoomView{200, 160};
constexpr float kFloorM = 3, kTableM = 2, kTableHalfM = 0.5F;

/// The camera looks straight down along z at a floor 3 m away, and at a table 1 m above it, 1 m
/// wide. World and camera have the same axes. A small virtual block stands on the floor to the
/// left.
struct TableRoom {
  explicit TableRoom(double lamp_side_m = 0, float block_x_m = -1.1F)
      : depth_m(make_image<float>(
            kRoomView, [&](int x, int y) { return table(ray(x, y)) ? kTableM : kFloorM; })),
        color(kRoomView, {0.4F, 0.4F, 0.4F}),
        setup(plain_setup(kRoomView, 100, {40, 32}, 20)) {
    setup.background.depth_m = depth_m;
    setup.background.color = color;
    setup.light.ambient = Eigen::Vector3f::Constant(0.2F);
    setup.light.lamps.push_back({{1, 0, 0.5}, std::nullopt, {lamp_side_m, lamp_side_m}, {4, 4, 4}});
    add_block(block_x_m);
  }
  static glm::vec2 ray(int x, int y) {
    return {(static_cast<float>(x) - 99.5F) / 100, (static_cast<float>(y) - 79.5F) / 100};
  }
  static bool table(glm::vec2 ray) {
    return std::max(std::abs(ray.x), std::abs(ray.y)) * kTableM <= kTableHalfM;
  }
  /// Two squares, 20 cm wide, 10 cm and 0 over the floor, that face the camera.
  void add_block(float x_m) {
    for (const float z : {kFloorM - 0.1F, kFloorM}) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (const glm::vec2 c : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        positions.emplace_back(x_m + 0.1F * c.x, 0.1F * c.y, z);
      for (const std::uint32_t i : {0U, 2U, 1U, 0U, 3U, 2U}) triangles.push_back(first + i);
    }
    normals.assign(positions.size(), {0, 0, -1});
    render::VirtualObject block;
    block.meshes.push_back({positions, normals, {}, triangles, glm::vec3(0.5F), {}, true});
    setup.objects.push_back(block);
  }
  /// The grid's point nearest to a place.
  float seen(const render::RoomShade& shade, glm::dvec3 at_m) const {
    const glm::ivec3 c(glm::round((at_m - shade.first_m) / shade.cell_m));
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(c, glm::ivec3(0))) &&
                glm::all(glm::lessThan(c, shade.cells)));
    return shade.share[static_cast<std::size_t>((c.z * shade.cells.y + c.y) * shade.cells.x + c.x)];
  }
  render::FrameOutput compose() {
    const Image<Rgb8> plate(kRoomView, {170, 170, 170});
    const Image<float> depth({40, 32}, 0);
    render::FrameOutput out;
    out.wanted = render::kAll;
    auto made = render::make_cpu_compositor(setup, 1);
    EXPECT_TRUE(made);
    if (!made) return out;
    EXPECT_TRUE((*made)->compose({plate, depth, {}}, out));
    return out;
  }

  Image<float> depth_m;
  Image<Rgbf> color;
  render::CompositorSetup setup;
  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> triangles;
};

/// Through the table's edges the lamp at (1, 0.5) sees the floor from -1.5 to 0.17 m.
TEST(RoomShade, a_table_hides_the_lamp_where_its_shadow_falls) {
  const TableRoom room;
  const render::RoomShade shade = render::make_room_shade(room.setup, {});
  ASSERT_EQ(shade.layers, 1);
  for (const double x : {-1.2, -1.1, -1.0}) EXPECT_EQ(room.seen(shade, {x, 0, 2.9}), 0) << x;
}

TEST(RoomShade, the_border_of_the_shadow_is_where_the_edge_projects_it) {
  const TableRoom room(0, -1.5F);
  const render::RoomShade shade = render::make_room_shade(room.setup, {});
  ASSERT_EQ(shade.layers, 1);
  // At 2.95 m the table's left edge is seen from the lamp at 1 - 1.5 * 2.45 / 1.5 = -1.45 m.
  EXPECT_EQ(room.seen(shade, {-1.35, 0, 2.95}), 0);
  EXPECT_EQ(room.seen(shade, {-1.55, 0, 2.95}), 1);
}

/// Half of a panel of 1 m^2 area is seen from where the edge halves it.
TEST(RoomShade, a_panel_is_hidden_by_parts) {
  const TableRoom room(1, -1.45F);
  const render::RoomShade shade = render::make_room_shade(room.setup, {});
  ASSERT_EQ(shade.layers, 1);
  EXPECT_NEAR(room.seen(shade, {-1.45, 0, 2.95}), 0.5, 0.15);
  EXPECT_LT(room.seen(shade, {-1.3, 0, 2.95}), room.seen(shade, {-1.6, 0, 2.95}));
}

TEST(RoomShade, what_no_real_thing_hides_costs_nothing) {
  const TableRoom room(0, 1.2F);  // in the light
  const render::RoomShade shade = render::make_room_shade(room.setup, {});
  EXPECT_TRUE(shade.empty());
  EXPECT_EQ(shade.layer_of, std::vector<int>{-1});
}

TEST(RoomShade, is_not_asked_for_where_the_room_is_not_shown) {
  TableRoom room;
  EXPECT_TRUE(render::needs_room_shade(room.setup));
  room.setup.open_walls = true;
  EXPECT_FALSE(render::needs_room_shade(room.setup));
  room.setup.open_walls = false;
  room.setup.backdrop.emplace();
  EXPECT_FALSE(render::needs_room_shade(room.setup));
  room.setup.backdrop.reset();
  room.setup.light.lamps.clear();
  EXPECT_FALSE(render::needs_room_shade(room.setup));
}

/// In the table's shade the block has ambient light alone, and casts no shadow of the lamp.
TEST(RoomShade, an_object_in_the_shade_is_dark_and_casts_no_second_shadow) {
  TableRoom shaded;
  const render::FrameOutput out = shaded.compose();
  const auto px = [](float x_m, float z_m) {
    return static_cast<int>(std::lround(99.5 + 100 * x_m / z_m));
  };
  // albedo 0.5, ambient 0.2: linear 0.1 is 89 in sRGB.
  EXPECT_NEAR(out.color.at(px(-1.1F, 2.9F), 80).r, 89, 1);
  EXPECT_EQ(*std::min_element(out.light.row(80), out.light.row(80) + kRoomView.width), 1);
  TableRoom lit(0, 1.2F);
  const render::FrameOutput bright = lit.compose();
  // 0.5 (0.2 + 4 cos / d^2): the lamp is 2.4 m over the block and 0.2 m aside.
  const double d2 = 2.4 * 2.4 + 0.2 * 0.2;
  const double linear = 0.5 * (0.2 + 4 * 2.4 / (d2 * std::sqrt(d2)));
  EXPECT_NEAR(bright.color.at(px(1.2F, 2.9F), 80).r,
              255 * (1.055 * std::pow(linear, 1 / 2.4) - 0.055), 2);
  EXPECT_LT(*std::min_element(bright.light.row(80), bright.light.row(80) + kRoomView.width), 0.4F);
}

/// If the first pose is known, the shade exists before the first frame, and is the same.
TEST(RoomShade, is_found_when_the_compositor_is_made_where_the_first_pose_is_known) {
  TableRoom room;
  const render::FrameOutput late = room.compose();
  EXPECT_TRUE(render::FramePreparer(room.setup).params().room_share.empty());
  room.setup.first_pose.emplace();
  render::FramePreparer preparer(room.setup);
  const auto share = preparer.params().room_share;
  ASSERT_FALSE(share.empty());
  preparer.update({});
  EXPECT_EQ(preparer.params().room_share.data(), share.data()) << "it is not made again";
  EXPECT_TRUE(preparer.params().room_changed) << "of the first frame";
  const render::FrameOutput early = room.compose();
  EXPECT_EQ(psnr_db(early.color, late.color), 100);
}

/// A panel keeps its parts while people cast shadows: people's occlusion of the whole panel comes
/// from the parts, and the objects' shadows stay fine.
TEST(RoomShade, panels_keep_their_parts_where_people_cast_shadows) {
  TableRoom room;
  room.setup.light.lamps = {{{0, -1.3, 2}, Eigen::Vector3d::UnitY(), {0.5, 0.5}, {1, 1, 1}}};
  room.setup.people_cast_shadows = true;
  EXPECT_EQ(render::FramePreparer(room.setup).params().lamps.size(), 4U);
  EXPECT_EQ(render::FramePreparer(room.setup).params().people_lamps.size(), 1U);
}

}  // namespace
}  // namespace mixrig::test
