// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <span>

#include "host/math/geometry/lamp.h"
#include "host/render/cpu/light/irradiance.h"
#include "host/render/cpu/light/visibility.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

using render::cpu::kLanes;

/// A lamp above a horizontal square caster. World and camera are one: y points down.
struct Lit {
  explicit Lit(geometry::Lamp lamp, float caster_y_m = 1, float half_m = 0.5F)
      : positions({{-half_m, caster_y_m, 2 - half_m},
                   {half_m, caster_y_m, 2 - half_m},
                   {half_m, caster_y_m, 2 + half_m},
                   {-half_m, caster_y_m, 2 + half_m}}),
        normals(4, glm::vec3(0, -1, 0)),
        triangles({0, 1, 2, 0, 2, 3}),
        setup(plain_setup({64, 64}, 64, {4, 4}, 4)),
        preparer((complete(lamp), setup)),
        maps(1) {
    preparer.update({});
    Crew crew(2);
    render::cpu::draw_shadow_maps(crew, preparer.params(), maps);
  }
  /// Share of the lamp that a point on a floor 2 m down sees.
  float seen(float x_m, float z_m, float y_m = 2) const {
    return seen_by(0, {x_m, y_m, z_m}, {0, -1, 0});
  }
  /// The point in lane `lane`, other points everywhere in the room in the others.
  float seen_by(int lane, glm::vec3 position_m, glm::vec3 normal) const {
    render::cpu::VectorLanes positions_m, all_normals;
    std::minstd_rand random(1);
    std::uniform_real_distribution<float> away(-3, 3);
    for (int i = 0; i < kLanes; ++i) {
      const glm::vec3 other(away(random), away(random), away(random));
      const glm::vec3 p = i == lane ? position_m : other;
      positions_m.x[i] = p.x, positions_m.y[i] = p.y, positions_m.z[i] = p.z;
      all_normals.x[i] = normal.x, all_normals.y[i] = normal.y, all_normals.z[i] = normal.z;
    }
    return render::cpu::visibility(preparer.params().lamps[0], maps[0], positions_m,
                                   all_normals)[lane];
  }

  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> triangles;
  render::CompositorSetup setup;
  render::FramePreparer preparer;
  std::vector<render::cpu::ShadowMap> maps;

 private:
  void complete(const geometry::Lamp& lamp) {
    render::VirtualObject object;
    object.meshes.push_back({positions, normals, {}, triangles, glm::vec3(1), {}, true});
    setup.objects.push_back(object);
    setup.light.lamps.push_back(lamp);
  }
};

geometry::Lamp point_lamp(const Eigen::Vector3d& position_m) { return {.position_m = position_m}; }

TEST(LampLight, is_in_lanes_what_the_formula_for_single_points_says) {
  std::minstd_rand random(5);
  std::uniform_real_distribution<double> away(-2, 2);
  const auto any = [&] { return Eigen::Vector3d(away(random), away(random), away(random)); };
  const auto to_glm = [](const Eigen::Vector3d& v) { return glm::vec3(render::to_glm(v)); };
  int lit = 0;
  for (int i = 0; i < 200; ++i) {
    geometry::Lamp of_formula{.position_m = any()};
    const Eigen::Vector3d normal = any().normalized();
    if (i % 2) of_formula.direction = any().normalized();
    render::LampParams lamp;
    lamp.position_m = to_glm(of_formula.position_m),
    lamp.direction = to_glm(of_formula.direction.value_or(Eigen::Vector3d::Zero()));
    lamp.intensity = glm::vec3(1);
    std::array<Eigen::Vector3d, kLanes> at_m;
    render::cpu::SurfaceLanes at;
    for (int k = 0; k < kLanes; ++k) {
      at_m[static_cast<std::size_t>(k)] = any();
      at.set(k, to_glm(at_m[static_cast<std::size_t>(k)]), to_glm(normal));
    }
    const render::cpu::FloatLanes light = render::cpu::lamp_light(lamp, at);
    for (int k = 0; k < kLanes; ++k) {
      const double expected =
          geometry::irradiance(of_formula, at_m[static_cast<std::size_t>(k)], normal);
      EXPECT_NEAR(light[k], expected, 1e-4 * (1 + expected));
      lit += expected > 0;
    }
  }
  EXPECT_GT(lit, 100);
}

TEST(Shadow, point_lamp_casts_the_projection_of_its_caster) {
  // Lamp at y = 0, caster 1 m below, floor 2 m below: the shadow is twice as wide, +-1 m.
  const Lit lit(point_lamp({0, 0, 2}));
  for (const float x : {-0.95F, -0.5F, 0.0F, 0.5F, 0.95F}) EXPECT_EQ(lit.seen(x, 2), 0) << x;
  for (const float x : {-1.05F, 1.05F, 1.5F, 40.0F}) EXPECT_EQ(lit.seen(x, 2), 1) << x;
}

TEST(Shadow, falls_on_the_far_side_of_a_slanting_lamp) {
  const Lit lit(point_lamp({-1, 0, 2}));  // the shadow reaches from 0 to 2 m
  EXPECT_EQ(lit.seen(1, 2), 0);
  EXPECT_EQ(lit.seen(-0.5F, 2), 1);
}

TEST(Shadow, what_lies_before_the_caster_is_lit) {
  const Lit lit(point_lamp({0, 0, 2}));
  EXPECT_EQ(lit.seen(0, 2, 0.5F), 1);
}

TEST(Shadow, wide_lamp_softens_the_border) {
  geometry::Lamp lamp = point_lamp({0, 0, 2});
  lamp.size_m = {0.4, 0.4};
  const Lit lit(lamp);
  EXPECT_EQ(lit.seen(0, 2), 0);
  EXPECT_NEAR(lit.seen(1, 2), 0.5F, 0.12F);
  EXPECT_GT(lit.seen(1.1F, 2), lit.seen(0.95F, 2));
  EXPECT_EQ(lit.seen(1.6F, 2), 1);
}

TEST(Shadow, caster_does_not_shadow_itself) {
  const Lit lit(point_lamp({0.3, 0, 1.8}));
  for (const float x : {-0.4F, 0.0F, 0.4F}) EXPECT_EQ(lit.seen(x, 2, 1), 1) << x;
}

/// A sheet, by its corners in turn.
render::VirtualObject sheet(std::span<const glm::vec3, 4> corners,
                            std::span<const glm::vec3> normal,
                            std::span<const std::uint32_t> triangles) {
  render::VirtualObject object;
  object.meshes.push_back({corners, normal, {}, triangles, glm::vec3(1), {}, true});
  return object;
}

/// Under the edge of a caster, on a slope that is in the map itself: what the lamp's filter meets
/// of the slope does not narrow the shadow.
TEST(Shadow, a_slope_has_the_penumbra_of_what_is_before_it) {
  const std::array<glm::vec3, 4> caster{{{0, 1, 1}, {1, 1, 1}, {1, 1, 3}, {0, 1, 3}}};
  const std::array<glm::vec3, 4> slope{{{-1, 1.2F, 1}, {1, 2.8F, 1}, {1, 2.8F, 3}, {-1, 1.2F, 3}}};
  const glm::vec3 up = glm::normalize(glm::vec3(0.8F, -1, 0));
  const std::vector<glm::vec3> normals(4, up);
  const std::vector<std::uint32_t> triangles{0, 1, 2, 0, 2, 3};
  render::CompositorSetup setup = plain_setup({64, 64}, 64, {4, 4}, 4);
  geometry::Lamp lamp = point_lamp({0, 0, 2});
  lamp.size_m = {0.4, 0.4};
  setup.light.lamps.push_back(lamp);
  setup.objects = {sheet(caster, normals, triangles), sheet(slope, normals, triangles)};
  render::FramePreparer preparer(setup);
  preparer.update({});
  std::vector<render::cpu::ShadowMap> both(1), alone(1);
  Crew crew(2);
  render::FrameParams params = preparer.params();
  render::cpu::draw_shadow_maps(crew, params, both);
  std::erase_if(params.draws, [](const render::Draw& draw) { return draw.object == 1; });
  render::cpu::draw_shadow_maps(crew, params, alone);
  double off = 0;
  int soft = 0;
  for (int k = -16; k <= 16; ++k) {
    const float x = 0.015F * static_cast<float>(k);
    const glm::vec3 p(x, 2 + 0.8F * x, 2);
    const render::LampParams& of = params.lamps[0];
    const float lift_m =
        render::kLiftTexels * render::transform(of.lamp_from_camera, p).z / of.map_focal_texel;
    const auto all = [](const glm::vec3& v) {
      render::cpu::VectorLanes lanes{};
      lanes.x += v.x, lanes.y += v.y, lanes.z += v.z;
      return lanes;
    };
    const float seen = render::cpu::visibility(of, both[0], all(p), all(up))[0];
    const float past_caster =
        render::cpu::visibility(of, alone[0], all(p + lift_m * up), all(glm::vec3(0)))[0];
    soft += past_caster > 0 && past_caster < 1;
    off += std::abs(seen - past_caster) / 33;
  }
  EXPECT_GT(soft, 10);
  EXPECT_LT(off, 0.02);
}

TEST(Shadow, panel_that_faces_away_has_no_map) {
  geometry::Lamp lamp = point_lamp({0, 0, 2});
  lamp.direction = -Eigen::Vector3d::UnitY();
  EXPECT_EQ(Lit(lamp).preparer.params().lamps[0].map_size_texel, 0);
}

TEST(Shadow, lamp_inside_its_caster_gives_finite_light) {
  const Lit lit(point_lamp({0, 1, 2}));
  for (const float x : {-1.0F, 0.0F, 1.0F}) {
    const float seen = lit.seen(x, 2);
    EXPECT_TRUE(seen >= 0 && seen <= 1);
  }
}

TEST(Shadow, a_point_is_lit_alike_in_every_lane) {
  geometry::Lamp lamp = point_lamp({0, 0, 2});
  lamp.size_m = {0.4, 0.4};
  const Lit lit(lamp);
  for (const float x : {0.0F, 0.9F, 1.0F, 1.1F, 1.6F})
    for (int lane = 1; lane < kLanes; ++lane)
      EXPECT_EQ(lit.seen_by(lane, {x, 2, 2}, {0, -1, 0}), lit.seen(x, 2)) << x << "," << lane;
}

TEST(Shadow, points_that_are_not_wanted_change_no_other) {
  geometry::Lamp lamp = point_lamp({0, 0, 2});
  lamp.size_m = {0.4, 0.4};
  const Lit lit(lamp);
  std::minstd_rand random(3);
  std::uniform_real_distribution<float> away(-2, 2), down(1.2F, 2);
  const render::LampParams& params = lit.preparer.params().lamps[0];
  int shadowed = 0, early = 0;
  for (int trial = 0; trial < 6400 / kLanes; ++trial) {
    render::cpu::VectorLanes at_m, normal{};
    for (int i = 0; i < kLanes; ++i) {
      at_m.x[i] = trial % 2 ? away(random) : 1.5F + 0.01F * away(random);
      at_m.y[i] = down(random), at_m.z[i] = 2 + away(random);
      normal.y[i] = -1;
    }
    render::cpu::IntLanes wanted{};
    for (int i = 0; i < kLanes; ++i) wanted[i] = -static_cast<int>(random() % 2);
    const auto all = visibility(params, lit.maps[0], at_m, normal);
    const auto some = visibility(params, lit.maps[0], at_m, normal, wanted);
    for (int i = 0; i < kLanes; ++i) {
      if (!wanted[i]) continue;
      EXPECT_EQ(some[i], all[i]) << trial << ", " << i;
      shadowed += all[i] < 1, early += all[i] == 1;
    }
  }
  EXPECT_GT(shadowed, 100);
  EXPECT_GT(early, 100);
}

TEST(Shadow, what_is_not_looked_up_would_be_lit) {
  geometry::Lamp lamp = point_lamp({0, 0, 2});
  lamp.size_m = {0.4, 0.4};
  const Lit lit(lamp);
  const render::LampParams& params = lit.preparer.params().lamps[0];
  std::minstd_rand random(5);
  std::uniform_real_distribution<float> within(-0.2F, 0.2F), away(-1.5F, 1.5F), down(1.2F, 2);
  int shadowed = 0, seen = 0;
  for (int trial = 0; trial < 6400 / kLanes; ++trial) {
    const glm::vec3 middle(away(random), down(random), 2 + away(random));
    render::cpu::VectorLanes at_m{}, normal{};
    for (int i = 0; i < kLanes; ++i)
      at_m.x[i] = middle.x + within(random), at_m.y[i] = middle.y,
      at_m.z[i] = middle.z + within(random), normal.y[i] = -1;
    const auto tested = visibility(params, lit.maps[0], at_m, normal);
    const auto all = visibility_of_caster(params, lit.maps[0], at_m, normal);
    for (int i = 0; i < kLanes; ++i) {
      EXPECT_EQ(tested[i], all[i]) << trial << ", " << i;
      shadowed += all[i] < 1, seen += all[i] == 1;
    }
  }
  EXPECT_GT(shadowed, 100);
  EXPECT_GT(seen, 100);
}

/// A box of view space: pixels [u, u + width] of a camera with f = 1, depths [near_m, far_m].
render::cpu::Corners corners(glm::vec2 ray, float width, float near_m, float far_m) {
  render::cpu::Corners out;
  for (int i = 0; i < 8; ++i) {
    render::cpu::Corners::Face& face = out.faces[i & 4 ? 1 : 0];
    const float z_m = i & 4 ? far_m : near_m;
    face.x_m[i % 4] = (ray.x + (i & 1 ? width : 0)) * z_m;
    face.y_m[i % 4] = (ray.y + (i & 2 ? width : 0)) * z_m;
    face.z_m[i % 4] = z_m;
  }
  return out;
}

TEST(Shadow, what_is_surely_lit_sees_all_of_the_lamp) {
  std::minstd_rand random(7);
  const auto between = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  int lit_boxes = 0, shadowed_points = 0;
  for (int trial = 0; trial < 60; ++trial) {
    geometry::Lamp lamp = point_lamp({between(-1, 1), between(-0.5F, 0.5F), between(1, 3)});
    const float side_m = between(0, 1);
    lamp.size_m = {side_m, side_m};
    const Lit lit(lamp, between(0.8F, 1.2F), between(0.1F, 0.8F));
    const render::LampParams& params = lit.preparer.params().lamps[0];
    for (int k = 0; k < 200; ++k) {
      const glm::vec2 ray(between(-1.5F, 1.5F), between(-1, 1.5F));
      const float width = between(0, 0.1F), near_m = between(0.5F, 3);
      const float far_m = near_m * between(1, 1.3F);
      const bool sure = !may_be_shadowed(params, lit.maps[0], corners(ray, width, near_m, far_m));
      lit_boxes += sure;
      for (int j = 0; j < 8; ++j) {
        const glm::vec3 on(ray.x + between(0, width), ray.y + between(0, width), 1);
        const glm::vec3 normal(between(-1, 1), between(-1, 1), between(-1, 1));
        const float seen =
            lit.seen_by(j % kLanes, on * between(near_m, far_m), glm::normalize(normal));
        shadowed_points += seen < 1;
        ASSERT_TRUE(!sure || seen == 1) << "trial " << trial << ", box " << k << ": " << seen;
      }
    }
  }
  EXPECT_GT(lit_boxes, 3000);
  EXPECT_GT(shadowed_points, 3000);
}

TEST(Shadow, boxes_away_from_the_shadow_are_surely_lit) {
  const Lit lit(point_lamp({0, 0, 2}));  // shadow of +-1 m on the floor
  const render::LampParams& lamp = lit.preparer.params().lamps[0];
  const auto may_be = [&](float x_m, float y_m, float z_m) {
    return may_be_shadowed(lamp, lit.maps[0],
                           corners(glm::vec2(x_m, y_m) / z_m, 0.02F, z_m, 1.01F * z_m));
  };
  EXPECT_TRUE(may_be(0, 2, 2));
  EXPECT_TRUE(may_be(0.9F, 2, 2));
  EXPECT_FALSE(may_be(1.25F, 2, 2));
  EXPECT_FALSE(may_be(-1.3F, 2, 2));
  EXPECT_FALSE(may_be(0, 0.8F, 2)) << "between lamp and caster";
}

TEST(Shadow, largest_w_holds_every_texel_of_its_rectangle_and_little_else) {
  std::minstd_rand random(3);
  for (const int size : {64, 100, 256}) {
    render::cpu::ShadowMap map;
    map.w.reset({size, size});
    std::uniform_int_distribution<int> texel(0, size - 1);
    for (int i = 0; i < size / 8; ++i)
      map.w.at(texel(random), texel(random)) = 0.1F + static_cast<float>(i);
    map.drawn = {0, 0, size, size};
    render::cpu::find_largest(map);
    std::uniform_real_distribution<float> anywhere(-8, static_cast<float>(size) + 8);
    const auto largest = [&](glm::vec2 low, glm::vec2 high) {
      float out = 0;
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          const glm::vec2 at(x, y);
          if (glm::clamp(at, low, high) == at) out = std::max(out, map.w.at(x, y));
        }
      return out;
    };
    for (int k = 0; k < 1000; ++k) {
      const glm::vec2 a(anywhere(random), anywhere(random)), b(anywhere(random), anywhere(random));
      const glm::vec2 low = glm::min(a, b), high = glm::max(a, b);
      const float found = render::cpu::largest_w(map, low.x, low.y, high.x, high.y);
      ASSERT_GE(found, largest(low, high)) << size << "," << k;
      // Windows of a square as long as the longer side, and whole cells.
      const float side = std::max(high.x - low.x, high.y - low.y) + render::cpu::kCellTexels;
      ASSERT_LE(found, largest(low - side, high + side)) << size << "," << k;
    }
    EXPECT_EQ(render::cpu::largest_w(map, -9, -9, -1, 500), 0);
  }
}

/// A floor 2 m below the camera seen by pixel rows below the horizon.
TEST(Light, ratio_of_the_background_is_by_hand) {
  Lit lit(point_lamp({0, 0, 2}));
  lit.setup.light.ambient = Eigen::Vector3f::Constant(0.2F);
  render::FramePreparer preparer(lit.setup);
  preparer.update({});
  const auto floor = make_image<float>(
      {64, 64}, [](int, int y) { return y > 40 ? 2 * 64 / (static_cast<float>(y) - 31.5F) : 0; });
  render::CompositorSetup with_background = lit.setup;
  with_background.background.depth_m = floor;
  const render::Tables tables = render::make_tables(with_background);
  render::cpu::LightLayer layer;
  layer.background.reset({64, 64});
  Crew crew(2);
  render::cpu::light_background(
      crew, {preparer.params(), tables, with_background.background, lit.maps}, layer);
  // Column 31, row 63: z = 4.06 m, lit. Nothing is known above the horizon: light 1.
  EXPECT_EQ(layer.background.at(31, 0), 65535);
  // z = 2.67 m at row 79.5 is outside; the shadow of +-1 m around z = 2 m ends before z = 3 m.
  for (int y = 41; y < 64; ++y) {
    const float z = floor.at(31, y);
    const bool shadowed = z < 2.9F;
    EXPECT_EQ(layer.background.at(31, y) < 65535, shadowed) << z;
  }
}

TEST(Light, of_a_pixel_that_shows_a_person_by_half_is_that_of_both) {
  Lit lit(point_lamp({0, 0, 2}));
  lit.setup.light.ambient = Eigen::Vector3f::Constant(0.2F);
  render::FramePreparer preparer(lit.setup);
  preparer.update({});
  const render::Tables tables = render::make_tables(lit.setup);
  render::cpu::LightLayer layer({64, 64});
  layer.background.fill(13107);  // 0.2, all of it behind a caster
  Image<std::uint8_t> matte({64, 64}, 255);
  // Columns of one tile between people, who stand in the light, and nobody.
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 64; ++x)
      matte.row(y)[x] = static_cast<std::uint8_t>(x == 32 ? 204 : x == 33 ? 51 : 0);
  const Image<float> w({64, 64}, 1 / 0.9F);  // above the caster
  Crew crew(2);
  const render::cpu::LightInput input{preparer.params(), tables, lit.setup.background, lit.maps};
  render::cpu::light_visible_background(crew, input, layer);
  render::cpu::light_people(crew, input, w, matte, layer);
  const auto at = [&](int x) { return layer.visible.at(x, 20) / 65535.0; };
  EXPECT_NEAR(at(16), 1, 1e-3);
  EXPECT_NEAR(at(32), 0.8 * 1 + 0.2 * 0.2, 1e-3);
  EXPECT_NEAR(at(33), 0.2 * 1 + 0.8 * 0.2, 1e-3);
  EXPECT_NEAR(at(34), 0.2, 1e-3);
}

TEST(Light, shading_is_lambert_by_hand) {
  Lit lit(point_lamp({0, 0, 2}));
  lit.setup.light.ambient = Eigen::Vector3f::Constant(0.1F);
  lit.setup.light.exposure = 0.5F;
  render::FramePreparer preparer(lit.setup);
  preparer.update({});
  const render::Tables tables = render::make_tables(lit.setup);
  render::cpu::VirtualLayer layer;
  layer.reset({64, 64}, false, false);
  layer.rect = {32, 32, 33, 33};
  layer.others.reset({0, 0, 64, 64});
  layer.coverage.reset({64, 64}, 255);
  layer.w.reset({64, 64}, 0.5F);  // 2 m before the camera, just right of and below the lamp
  layer.normal.reset({64, 64}, {0, -127, 0, 0});
  layer.color.reset({64, 64}, {32768, 32768, 32768, 0});
  Crew crew(1);
  const std::vector<render::cpu::ShadowMap> no_shadow(1);
  render::cpu::shade_virtual(crew, {preparer.params(), tables, {}, no_shadow}, layer);
  // The pixel lies 1/64 m right of and below the lamp: cos = 1 / sqrt 2, d^2 = 2 / 64^2.
  EXPECT_EQ(layer.color.at(32, 32).r, 65535) << "so near that it is clipped";
  layer.rect = {31, 63, 32, 64};
  layer.color.reset({64, 64}, {32768, 32768, 32768, 0});
  render::cpu::shade_virtual(crew, {preparer.params(), tables, {}, no_shadow}, layer);
  const double y_m = 2 * 31.5 / 64, x_m = 2 * -0.5 / 64, d2 = x_m * x_m + y_m * y_m;
  const double light = 0.1 + y_m / std::sqrt(d2) / d2;
  EXPECT_NEAR(layer.color.at(31, 63).r, std::min(1.0, 0.5 * 0.5 * light) * 65535, 300);
  // Half of the pixel shows a surface that faces away from the lamp: each has its own light.
  const render::cpu::Rgbx16 half{16384, 16384, 16384, 0};
  layer.color.reset({64, 64}, half);
  layer.others.add(63, {31, 0.5F, {0, 127, 0, render::cpu::kWholeShare / 2}, {}, half, {}, {}});
  render::cpu::shade_virtual(crew, {preparer.params(), tables, {}, no_shadow}, layer);
  EXPECT_NEAR(layer.color.at(31, 63).r, 0.25 * 0.5 * (light + 0.1) * 65535, 300);
}

}  // namespace
}  // namespace mixrig::test
