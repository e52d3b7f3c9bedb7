// SPDX-License-Identifier: Apache-2.0
// Shadow maps and light: a lamp, a square before a wall, and the shadow where geometry puts it.
#include "host/render/gles/light/light_pass.h"

#include <cmath>
#include <optional>

#include "host/math/geometry/lamp.h"
#include "host/render/gles/key/key_pass.h"
#include "host/render/gles/light/shadow_pass.h"
#include "tests/gl/gl_fixture.h"
#include "tests/gl/quad_mesh.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

// The wall stands at 3 m, 32 x 32 pixels, f = 32: a pixel is 3 / 32 m of wall.
constexpr Size kLightView{32, 32};
constexpr float kWallM = 3;

class LightPassTest : public GlTest {
 protected:
  LightPassTest() {
    tables_.view_size = kLightView;
    tables_.warp.view = {{32, 32}, {15.5F, 15.5F}};
    tables_.has_background = true;
    tables_.background_normal.reset(kLightView, {0, 0, -127, 0});
    params_.light.ambient = glm::vec3(0.25F);
    setup_.light.lamps.resize(1);
    // The lamp is at the camera's left and looks along z; its map spans 2 m to either side at 1 m.
    lamp_.position_m = {-0.5F, 0, 0};
    lamp_.intensity = glm::vec3(9);
    lamp_.lamp_from_camera[3] = glm::vec4(0.5F, 0, 0, 1);
    lamp_.map_size_texel = 256;
    lamp_.map_center_texel = 127.5F;
    lamp_.map_focal_texel = 63.75F;
    lamp_.casters_near_m = 0.5F;
    params_.lamps = {lamp_};
    params_.lamp_from_object = {{lamp_.lamp_from_camera}};
  }
  static glm::vec3 wall_at(int x, int y) {
    return kWallM * glm::vec3((glm::vec2(x, y) - 15.5F) / 32.0F, 1);
  }
  /// Irradiance of the wall by the lamp, by the formula for single points.
  float irradiance_at(const glm::vec3& wall) const {
    const auto to_eigen = [](const glm::vec3& v) { return render::to_eigen(glm::dvec3(v)); };
    return lamp_.intensity.r *
           static_cast<float>(geometry::irradiance({.position_m = to_eigen(lamp_.position_m)},
                                                   to_eigen(wall), -Eigen::Vector3d::UnitZ()));
  }
  /// Draws the shadow map of `caster` and returns the light on the wall.
  Image<glm::vec4> draw(const Quad& caster) {
    params_.draws = {draw_of(caster, tables_.warp.view)};
    meshes_.clear();
    meshes_.emplace_back(caster.view);
    auto shadow = ShadowPass::create();
    auto light = LightPass::create(tables_, setup_);
    EXPECT_TRUE(shadow && light);
    EXPECT_TRUE(shadow->draw(params_, meshes_));
    light->set_lamps(params_);
    const Image<float> wall(kLightView, wall_m_);
    light->draw_background(make_texture(wall.view(), GL_R32F), shadow->maps());
    return read(light->background_light());
  }

  render::Tables tables_;
  render::CompositorSetup setup_;
  render::LampParams lamp_;
  render::FrameParams params_;
  std::vector<GpuMesh> meshes_;
  float wall_m_ = kWallM;
};

TEST_F(LightPassTest, shadow_of_a_point_lamp_lies_where_rays_are_cut) {
  const Quad caster({-0.3F, -0.2F}, {0.1F, 0.2F}, 1.5F);
  const auto light = draw(caster);
  int dark = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const glm::vec3 wall = wall_at(x, y);
      const glm::vec3 hit = 0.5F * (wall + lamp_.position_m);  // the ray at z = 1.5
      const float inside = std::min(std::min(hit.x + 0.3F, 0.1F - hit.x), 0.2F - std::abs(hit.y));
      if (std::abs(inside) < 0.06F) continue;  // two texels of the map and one of the filter
      const float expected = inside > 0 ? 0.25F / (0.25F + irradiance_at(wall)) : 1;
      EXPECT_NEAR(light.at(x, y).r, expected, 1e-3F) << x << "," << y;
      dark += inside > 0;
    }
  EXPECT_GT(dark, 20);
}

TEST_F(LightPassTest, large_lamp_has_a_penumbra_and_a_panel_lights_one_side) {
  params_.lamps[0].radius_m = 0.4F;
  const Quad caster({-0.3F, -0.2F}, {0.1F, 0.2F}, 1.5F);
  const auto soft = draw(caster);
  int between = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) between += soft.at(x, y).r > 0.4F && soft.at(x, y).r < 0.95F;
  EXPECT_GT(between, 20);
  params_.lamps[0].direction = {0, 0, -1};  // faces away from the wall: no light to lose
  const auto away = draw(caster);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) EXPECT_EQ(away.at(x, y).r, 1);
}

TEST_F(LightPassTest, nothing_in_the_way_is_lit_and_unknown_depth_too) {
  const Quad behind({-3, -3}, {3, 3}, 3.5F);  // behind the wall
  const auto lit = draw(behind);
  wall_m_ = 0;
  const Quad before({-3, -3}, {3, 3}, 1.5F);
  const auto unknown = draw(before);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      EXPECT_EQ(lit.at(x, y).r, 1);
      EXPECT_EQ(unknown.at(x, y).r, 1);
    }
}

TEST_F(LightPassTest, person_takes_the_shadow_of_its_own_surface) {
  const Quad caster({-0.3F, -0.2F}, {0.1F, 0.2F}, 1.5F);
  const auto wall = draw(caster);
  auto shadow = ShadowPass::create();
  auto light = LightPass::create(tables_, setup_);
  ASSERT_TRUE(shadow && light);
  ASSERT_TRUE(shadow->draw(params_, meshes_));
  light->set_lamps(params_);
  const Image<float> wall_m(kLightView, kWallM),
      person_w(kLightView, 1.0F);  // a person at 1 m, in front of everything
  light->draw_background(make_texture(wall_m.view(), GL_R32F), shadow->maps());
  // The left half is person, the right half background.
  const auto matte = make_image<std::uint8_t>(
      kLightView, [](int x, int) { return static_cast<std::uint8_t>(x < 16 ? 255 : 0); });
  const Image<float> blocks({4, 4}, static_cast<float>(kMayShowPeople));
  const Texture of_blocks = make_texture(blocks.view(), GL_R32F);
  const Texture of_matte = make_texture(matte.view(), GL_R8);
  const Texture of_w = make_texture(person_w.view(), GL_R32F);
  light->draw_people({of_blocks, of_matte, of_w}, shadow->maps(), {});
  const auto seen = read(light->light());
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      EXPECT_EQ(seen.at(x, y).r, x < 16 ? 1.0F : wall.at(x, y).r) << x << "," << y;
}

TEST_F(LightPassTest, virtual_surface_is_shaded_by_lamp_and_ambient) {
  Quad panel({-3, -3}, {3, 3}, kWallM);
  panel.view.base_color = {0.5F, 0.25F, 1};
  params_.draws = {draw_of(panel, tables_.warp.view)};
  params_.virtual_rect = {4, 4, 28, 28};
  params_.lamps[0].map_size_texel = 0;  // no shadow
  params_.light.exposure = 0.5F;
  std::vector<GpuMesh> meshes;
  meshes.emplace_back(panel.view);
  auto samples = VirtualPass::create();
  auto light = LightPass::create(tables_, setup_);
  ASSERT_TRUE(samples && light);
  ASSERT_TRUE(samples->draw(params_, meshes));
  light->set_lamps(params_);
  light->shade_virtual(params_, *samples, 0);
  const auto color = read(light->virtual_color());
  const auto w = read(light->virtual_w());
  const float sum = 0.25F + irradiance_at(wall_at(20, 15));
  EXPECT_NEAR(color.at(20, 15).r, 0.5F * 0.5F * sum, 0.004F);
  EXPECT_NEAR(color.at(20, 15).g, 0.5F * 0.25F * sum, 0.004F);
  EXPECT_EQ(color.at(20, 15).a, 1);
  EXPECT_NEAR(w.at(20, 15).r, 1 / kWallM, 1e-5F);
  EXPECT_EQ(color.at(2, 15), glm::vec4(0));  // outside the drawn rectangle
}

}  // namespace
}  // namespace mixrig::test
