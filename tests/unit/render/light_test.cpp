// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light.h"

#include <cmath>

#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

using render::cpu::visibility;

/// A lamp above a horizontal square caster. World and camera are one: y points down.
struct Lit {
  explicit Lit(render::Lamp lamp, float caster_y_m = 1, float half_m = 0.5F)
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
  /// What a point on a floor 2 m down sees of the lamp.
  float seen(float x_m, float z_m, float y_m = 2) const {
    return visibility(preparer.params().lamps[0], maps[0], {x_m, y_m, z_m}, {0, -1, 0});
  }

  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> triangles;
  render::CompositorSetup setup;
  render::FramePreparer preparer;
  std::vector<render::cpu::ShadowMap> maps;

 private:
  void complete(const render::Lamp& lamp) {
    render::VirtualObject object;
    object.meshes.push_back({positions, normals, {}, triangles, glm::vec3(1), {}, true});
    setup.objects.push_back(object);
    setup.light.lamps.push_back(lamp);
  }
};

render::Lamp point_lamp(glm::dvec3 position_m) {
  return {position_m, std::nullopt, {0, 0}, glm::vec3(1)};
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
  render::Lamp lamp = point_lamp({0, 0, 2});
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

TEST(Shadow, panel_that_faces_away_has_no_map) {
  render::Lamp lamp = point_lamp({0, 0, 2});
  lamp.direction = glm::dvec3(0, -1, 0);
  EXPECT_EQ(Lit(lamp).preparer.params().lamps[0].map_size_texel, 0);
}

TEST(Shadow, lamp_inside_its_caster_gives_finite_light) {
  const Lit lit(point_lamp({0, 1, 2}));
  for (const float x : {-1.0F, 0.0F, 1.0F}) {
    const float seen = lit.seen(x, 2);
    EXPECT_TRUE(seen >= 0 && seen <= 1);
  }
}

/// A floor 2 m below the camera seen by pixel rows below the horizon.
TEST(Light, ratio_of_the_background_is_by_hand) {
  Lit lit(point_lamp({0, 0, 2}));
  lit.setup.light.ambient = glm::vec3(0.2F);
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
  EXPECT_EQ(layer.background.at(31, 63 - 63), 65535);
  EXPECT_EQ(layer.background.at(31, 60), layer.background.at(31, 60));
  // z = 2.67 m at row 79.5 is outside; the shadow of +-1 m around z = 2 m ends before z = 3 m.
  for (int y = 41; y < 64; ++y) {
    const float z = floor.at(31, y);
    const bool shadowed = z < 2.9F;
    EXPECT_EQ(layer.background.at(31, y) < 65535, shadowed) << z;
  }
}

TEST(Light, shading_is_lambert_by_hand) {
  Lit lit(point_lamp({0, 0, 2}));
  lit.setup.light.ambient = glm::vec3(0.1F);
  lit.setup.light.exposure = 0.5F;
  render::FramePreparer preparer(lit.setup);
  preparer.update({});
  const render::Tables tables = render::make_tables(lit.setup);
  render::cpu::VirtualLayer layer;
  layer.rect = {32, 32, 33, 33};
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
}

}  // namespace
}  // namespace mixrig::test
