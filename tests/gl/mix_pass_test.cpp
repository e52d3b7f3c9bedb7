// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/mix/mix_pass.h"

#include <array>
#include <cmath>

#include "host/render/gles/gl/read_back.h"
#include "tests/gl/gl_fixture.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

constexpr Size kMixView{16, 16};

float srgb_byte(float linear) {
  return 255 *
         (linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F);
}

/// All pixels are alike: plate 0.5 grey, wall at 4 m, virtual layer and person as each test sets
/// them.
class MixPassTest : public GlTest {
 protected:
  struct Out {
    glm::vec4 color;  ///< bytes; matte in alpha
    float mixed_m = 0, segmented_m = 0;
    int layer = 0;
  };
  Out draw() {
    render::Tables tables;
    tables.view_size = kMixView;
    tables.has_background = true;
    render::CompositorSetup setup;
    setup.objects.resize(1);
    const Image<Rgbf> learned_color(kMixView, {0.2F, 0.2F, 0.2F});
    setup.background.color = learned_color;
    auto pass = MixPass::create(tables, setup);
    EXPECT_TRUE(pass);
    const Image<std::uint8_t> matte_bytes(kMixView, matte);
    const Texture plate = make_texture(Image<Rgb8>(kMixView, plate_bytes).view(), GL_SRGB8);
    const Texture visible_w = make_texture(Image<float>(kMixView, w).view(), GL_R32F);
    const Texture mattes = make_texture(matte_bytes.view(), GL_R8);
    const Texture wall = make_texture(Image<float>(kMixView, wall_m).view(), GL_R32F);
    const Texture learned = make_texture(learned_color.view(), GL_RGB16F);
    const Texture lights = make_texture(Image<float>(kMixView, light).view(), GL_R32F);
    Texture virtual_color = make_texture(kMixView, GL_RGBA16F);
    Texture virtual_w = make_texture(Image<float>(kMixView, 1 / virtual_m).view(), GL_R32F);
    auto target = make_target({&virtual_color});
    EXPECT_TRUE(target);
    bind(*target);
    glClearColor(shaded.r, shaded.g, shaded.b, shaded.a);
    glClear(GL_COLOR_BUFFER_BIT);
    const Texture people = make_texture(
        Image<float>(blocks_of(kMixView), matte > 0 ? static_cast<float>(kMayShowPeople) : 0.0F)
            .view(),
        GL_R32F);
    MixInput input;
    input.plate = &plate, input.people = &people, input.visible_w = &visible_w;
    input.matte = &mattes, input.background_m = &wall, input.learned = &learned;
    input.light = &lights;
    input.virtual_color = &virtual_color, input.virtual_w = &virtual_w;
    input.objects = objects, input.tone = tone;
    EXPECT_TRUE(pass->draw(input, render::kAll));
    std::array<ReadBack, 4> read_backs;
    read_backs[0].start_rgba(pass->target(), kMixColor);
    read_backs[1].start_float(pass->target(), kMixDepth);
    read_backs[2].start_float(pass->target(), kMixSegmented);
    read_backs[3].start_byte(pass->target(), kMixLayer);
    Image<Rgb8> color(kMixView);
    Image<float> mixed(kMixView), segmented(kMixView);
    Image<std::uint8_t> alpha(kMixView), layer(kMixView);
    EXPECT_TRUE(read_backs[0].fetch(color, alpha));
    EXPECT_TRUE(read_backs[1].fetch(mixed));
    EXPECT_TRUE(read_backs[2].fetch(segmented));
    EXPECT_TRUE(read_backs[3].fetch(layer));
    const Rgb8 p = color.at(3, 2);
    return {glm::vec4(p.r, p.g, p.b, alpha.at(3, 2)), mixed.at(3, 2), segmented.at(3, 2),
            layer.at(3, 2)};
  }

  Rgb8 plate_bytes{188, 188, 188};  // 0.5029 in linear light
  std::uint8_t matte = 0;
  render::ToneCurve tone;
  float w = 0.25F, wall_m = 4, light = 1, virtual_m = 3;
  glm::vec4 shaded{0.1F, 0.3F, 0.05F, 1};  // premultiplied
  render::Rect objects{0, 0, kMixView.width, kMixView.height};
};

/// Blocks that neither people nor objects may touch are drawn by a program of their own.
TEST_F(MixPassTest, a_block_of_the_room_alone_is_what_a_block_with_nobody_is) {
  shaded = glm::vec4(0), light = 0.3F;
  for (const float known_m : {4.0F, 0.0F}) {
    wall_m = known_m;
    objects = {0, 0, kMixView.width, kMixView.height};
    const Out mixed = draw();
    objects = {};
    const Out alone = draw();
    EXPECT_NEAR(alone.color.g, srgb_byte(0.3F * 0.5029F), 1);
    EXPECT_EQ(alone.color, mixed.color);
    EXPECT_FLOAT_EQ(alone.mixed_m, 4) << "the wall's, or as measured";
    EXPECT_EQ(mixed.mixed_m, alone.mixed_m);
    EXPECT_EQ(alone.segmented_m, 0);
    EXPECT_EQ(alone.layer, 0);
  }
}

TEST_F(MixPassTest, an_object_is_drawn_where_it_may_be_and_nowhere_else) {
  objects = {render::kBlockPx - 1, render::kBlockPx - 1, kMixView.width,
             kMixView.height};  // of the first block
  EXPECT_NEAR(draw().color.g, srgb_byte(0.3F), 1);
  objects = {render::kBlockPx, 0, kMixView.width, kMixView.height};
  EXPECT_NEAR(draw().color.g, srgb_byte(0.5029F), 1);
}

TEST_F(MixPassTest, half_covered_pixel_of_a_person_is_matted_with_the_learned_wall) {
  matte = 51;  // 0.2
  w = 0.5F;
  light = 0.5F;
  shaded = {0.1F, 0.15F, 0.025F, 0.5F};
  // Expected: P s + (1 - a) (C - v B s) = 0.25 + 0.8 (0.15 - 0.5 x 0.1) = 0.33 in green, with P =
  // 0.5029.
  const Out out = draw();
  EXPECT_NEAR(out.color.g, srgb_byte(0.2514F + 0.8F * (0.15F - 0.05F)), 1);
  EXPECT_EQ(out.layer, static_cast<int>(render::Layer::kBackground));  // 0.4 of it is virtual
  EXPECT_NEAR(out.mixed_m, 4, 1e-5F);
}

TEST_F(MixPassTest, wrong_matte_takes_no_more_wall_out_of_a_pixel_than_is_in_it) {
  matte = 51;
  w = 0.5F;
  plate_bytes = {188, 89, 188};  // green 0.1: half of the wall's 0.2, so b = 0.5 and not 0.8
  const Out out = draw();
  EXPECT_NEAR(out.color.g, srgb_byte(0.5F * 0.3F), 1);
  EXPECT_NEAR(out.color.r, srgb_byte(0.5029F + 0.5F * (0.1F - 0.2F)), 1);
}

TEST_F(MixPassTest, gain_of_the_camera_brightens_the_object) {
  tone = render::ToneCurve({2, 1, 0.5F});
  const Out out = draw();
  EXPECT_NEAR(out.color.r, srgb_byte(0.2F), 1);
  EXPECT_NEAR(out.color.g, srgb_byte(0.3F), 1);
  EXPECT_NEAR(out.color.b, srgb_byte(0.025F), 1);
}

/// The pixel is half covered; the tone curve must be applied to the object's own colour, before it
/// is weighted by coverage.
TEST_F(MixPassTest, tones_of_the_camera_are_those_of_the_object) {
  tone.bends = true;  // slope 1 up to a quarter, one half above
  for (std::size_t i = 4; i < tone.slope.size(); ++i) tone.slope[i] = glm::vec3(0.5F);
  shaded = {0.05F, 0.3F, 0.2F, 0.5F};
  const Out out = draw();
  EXPECT_NEAR(out.color.r, srgb_byte(0.05F + 0.5F * 0.5029F), 1);
  EXPECT_NEAR(out.color.g, srgb_byte(0.5F * (0.25F + 0.5F * 0.35F) + 0.5F * 0.5029F), 1);
  EXPECT_NEAR(out.color.b, srgb_byte(0.5F * (0.25F + 0.5F * 0.15F) + 0.5F * 0.5029F), 1);
}

TEST_F(MixPassTest, light_map_scales_the_plate_in_linear_light) {
  shaded = glm::vec4(0);
  light = 0.25F;
  EXPECT_NEAR(draw().color.b, srgb_byte(0.25F * 0.5029F), 1);
}

}  // namespace
}  // namespace mixrig::test
