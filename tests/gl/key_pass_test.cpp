// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/key/key_pass.h"

#include "tests/gl/gl_fixture.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

constexpr Size kKeyView{64, 64};

/// A wall at 4 m (w = 0.25, limit 0.3), dark red; people are bright green.
class KeyPassTest : public GlTest {
 protected:
  KeyPassTest() {
    tables_.view_size = kKeyView;
    tables_.has_background = true;
    tables_.key_limit_w.reset(kKeyView, 0.3F);
    tables_.warp.view = {{64, 64}, {31.5F, 31.5F}};
    w_.reset(kKeyView, 0.25F);
    plate_.reset(kKeyView, kWall);
    learned_.reset(kKeyView, {kWallLinear, 0, 0});
  }
  /// A person at 2 m: w in [x0, x1) x [y0, y1), and what the plate shows there.
  void put(int x0, int y0, int x1, int y1, bool depth = true, bool color = true) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        if (depth) w_.at(x, y) = 0.5F;
        if (color) plate_.at(x, y) = kGreen;
      }
  }
  void draw() {
    auto pass = KeyPass::create(tables_, {use_color_, false}, params_);
    ASSERT_TRUE(pass) << pass.error().context;
    const Texture w = make_texture(w_.view(), GL_R32F), none;
    const Texture plate = make_texture(plate_.view(), GL_SRGB8);
    const Texture learned = make_texture(learned_.view(), GL_RGB16F);
    pass->draw(params_, {w, plate, learned, none});
    matte_ = read(pass->matte());
    visible_w_ = read(pass->visible_w());
  }
  float matte(int x, int y) const { return matte_.at(x, y).r; }

  static constexpr Rgb8 kWall{120, 0, 0}, kGreen{20, 200, 20};
  static constexpr float kWallLinear = 0.1878F;
  render::Tables tables_;
  render::KeyPassParams params_;
  bool use_color_ = true;
  Image<float> w_;
  Image<Rgb8> plate_;
  Image<Rgbf> learned_;
  Image<glm::vec4> matte_, visible_w_;
};

TEST_F(KeyPassTest, person_before_the_limit_is_keyed) {
  put(16, 16, 40, 64);
  draw();
  EXPECT_EQ(matte(28, 40), 1);
  EXPECT_EQ(matte(18, 40), 1);
  EXPECT_EQ(matte(5, 40), 0);
  EXPECT_EQ(matte(60, 8), 0);
  EXPECT_FLOAT_EQ(visible_w_.at(28, 40).r, 0.5F);
  EXPECT_FLOAT_EQ(visible_w_.at(5, 40).r, 0.25F);
}

TEST_F(KeyPassTest, unknown_and_background_depth_never_key_alone) {
  w_.fill(0);
  plate_.fill(kGreen);  // colour alone, far from any measured person, is no person
  draw();
  for (int x = 0; x < 64; x += 7) EXPECT_EQ(matte(x, 30), 0) << x;
}

TEST_F(KeyPassTest, speckles_are_dropped) {
  put(20, 20, 22, 22);  // 4 pixels; six ToF pixels of one view pixel each would stay
  draw();
  EXPECT_EQ(matte(20, 20), 0);
  put(20, 20, 24, 24);
  draw();
  EXPECT_GT(matte(22, 22), 0.5F);
}

TEST_F(KeyPassTest, color_moves_the_border_where_depth_reaches_too_far) {
  params_.refine = false;
  put(16, 0, 40, 64);
  put(40, 0, 42, 64, true, false);  // depth says person, colour shows the wall
  put(13, 0, 16, 64, false, true);  // depth says wall, colour shows the person
  for (int y = 0; y < 64; ++y) w_.at(14, y) = w_.at(15, y) = w_.at(13, y) = 0;  // or nothing
  draw();
  EXPECT_EQ(matte(41, 30), 0);
  EXPECT_EQ(matte(15, 30), 1);
  EXPECT_FLOAT_EQ(visible_w_.at(15, 30).r, 0.5F);  // the depth of the person around
  EXPECT_EQ(visible_w_.at(41, 30).r, 0);           // what reached over is no depth of the wall
  use_color_ = false;
  draw();
  EXPECT_GT(matte(40, 30), 0.5F);  // without colour depth decides
}

TEST_F(KeyPassTest, shadow_on_the_wall_is_no_person) {
  put(16, 0, 40, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 40; x < 64; ++x) plate_.at(x, y) = {100, 0, 0};  // 0.67 of the light
  draw();
  EXPECT_EQ(matte(44, 30), 0);
}

TEST_F(KeyPassTest, the_refined_matte_has_the_border_of_the_plate) {
  put(16, 0, 40, 64);
  put(40, 0, 44, 64, true, false);  // depth says person, colour shows the wall
  draw();
  for (int x = 18; x < 40; ++x) EXPECT_GT(matte(x, 40), 0.5F) << x;
  for (int x = 40; x < 64; ++x) EXPECT_LT(matte(x, 40), 0.5F) << x;
}

TEST_F(KeyPassTest, what_is_measured_nearer_is_kept_where_the_background_has_no_depth) {
  put(16, 0, 48, 64);
  tables_.key_limit_w.fill(render::kNoLimitW);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 32; ++x) tables_.key_limit_w.at(x, y) = 0.3F;
  for (int y = 0; y < 64; ++y) w_.at(36, y) = 0.8F;
  draw();
  EXPECT_GT(matte(36, 30), 0.5F);
  EXPECT_FLOAT_EQ(visible_w_.at(36, 30).r, 0.8F);
}

TEST_F(KeyPassTest, a_negative_limit_is_of_the_background_around_a_hole) {
  use_color_ = false;
  put(16, 0, 48, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 32; x < 64; ++x) tables_.key_limit_w.at(x, y) = -0.33F;
    for (int x = 48; x < 64; ++x) w_.at(x, y) = 0.2F;
  }
  draw();
  EXPECT_EQ(matte(24, 30), 1);
  EXPECT_EQ(matte(40, 30), 1) << "nearer";
  EXPECT_LT(matte(60, 30), 0.5F) << "farther: in doubt";
  EXPECT_FLOAT_EQ(visible_w_.at(40, 30).r, 0.5F);
}

TEST_F(KeyPassTest, what_is_brighter_than_measured_background_is_no_shadow) {
  params_.refine = false;
  put(16, 0, 48, 40);
  put(16, 40, 48, 46, false, true);  // the feet are nearer to the wall than its noise
  draw();
  EXPECT_EQ(matte(32, 43), 1);
  EXPECT_EQ(matte(32, 52), 0);
}

TEST_F(KeyPassTest, a_shirt_like_the_wall_beside_dark_trousers_is_compared_with_the_shirt) {
  put(8, 0, 48, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 8; x < 48; ++x) {
      plate_.at(x, y) = y < 32 ? Rgb8{124, 0, 0} : Rgb8{0, 0, 60};
      if (y >= 24 && y < 32 && x < 16) w_.at(x, y) = 0;
    }
  draw();
  for (int y = 25; y < 31; ++y)
    for (int x = 9; x < 15; ++x) EXPECT_GT(matte(x, y), 0.5F) << x << "," << y;
  EXPECT_LT(matte(5, 28), 0.5F);
}

TEST_F(KeyPassTest, a_strip_of_the_room_under_peoples_depth_is_no_colour_of_people) {
  put(8, 0, 36, 64);
  put(36, 0, 44, 64, true, false);
  draw();
  for (int y = 8; y < 56; ++y) {
    EXPECT_GT(matte(34, y), 0.5F) << y;
    for (int x = 38; x < 64; ++x) EXPECT_LT(matte(x, y), 0.5F) << x << "," << y;
  }
}

TEST_F(KeyPassTest, what_no_shade_of_the_background_explains_outweighs_its_measured_depth) {
  params_.refine = false;
  for (const bool is_sole : {true, false}) {
    w_.fill(0.25F);
    plate_.fill(kWall);
    put(16, 0, 48, 40);
    for (int y = 0; y < 46; ++y)
      for (int x = 16; x < 48; ++x)
        plate_.at(x, y) = y < 40 || is_sole ? Rgb8{60, 60, 60} : Rgb8{72, 0, 0};
    draw();
    EXPECT_EQ(matte(32, 43), is_sole ? 1 : 0);
    EXPECT_EQ(matte(32, 52), 0);
  }
}

TEST_F(KeyPassTest, a_patch_like_the_wall_inside_people_is_no_hole_but_a_gap_between_legs_is) {
  params_.refine = false;
  for (const bool is_shirt : {true, false}) {
    w_.fill(0.25F);
    put(8, 0, 56, 64);
    for (int y = 0; y < 64; ++y)
      for (int x = 8; x < 56; ++x) plate_.at(x, y) = is_shirt ? Rgb8{134, 0, 10} : Rgb8{30, 30, 90};
    for (int y = 20; y < 44; ++y)
      for (int x = 29; x < 34; ++x) plate_.at(x, y) = kWall;
    for (const int y : {8, 9, 52, 53}) w_.at(30, y) = w_.at(31, y) = 0;  // votes decide here
    draw();
    EXPECT_EQ(matte(31, 22) > 0.5F, is_shirt);
    EXPECT_EQ(matte(31, 42) > 0.5F, is_shirt);
  }
}

TEST_F(KeyPassTest, a_few_near_pixels_beside_what_a_mirror_shows_are_nobody) {
  use_color_ = false;
  for (const bool mirrored : {true, false}) {
    w_.fill(0);
    tables_.key_limit_w.fill(-0.33F);
    put(28, 20, 32, 24);
    if (mirrored)
      for (int y = 24; y < 52; ++y)
        for (int x = 24; x < 40; ++x) w_.at(x, y) = 0.2F;
    draw();
    EXPECT_EQ(matte(30, 22) == 0, mirrored);
  }
}

TEST_F(KeyPassTest, what_is_unknown_beside_what_a_mirror_shows_is_nobody) {
  for (const bool mirrored : {true, false}) {
    plate_.fill(kWall);
    put(8, 8, 28, 56, true, false);
    for (int y = 8; y < 56; ++y)
      for (int x = 8; x < 48; ++x)
        if (x < 28 || (x >= 32 && y >= 24 && y < 40)) plate_.at(x, y) = {74, 0, 0};
    for (int y = 0; y < 64; ++y)
      for (int x = 28; x < 64; ++x) tables_.key_limit_w.at(x, y) = -0.33F, w_.at(x, y) = 0;
    if (mirrored)
      for (int y = 28; y < 36; ++y)
        for (int x = 40; x < 44; ++x) w_.at(x, y) = 0.2F;
    draw();
    EXPECT_EQ(matte(20, 32), 1);
    EXPECT_EQ(matte(36, 32) > 0.5F, !mirrored);
  }
}

TEST_F(KeyPassTest, points_outside_the_capture_box_are_cropped) {
  put(0, 0, 64, 64);
  params_.crop = true;
  params_.crop_min_m = {0, -9, 0};  // world axes are the camera's: only the right half
  params_.crop_max_m = {9, 9, 9};
  draw();
  EXPECT_EQ(matte(10, 30), 0);
  EXPECT_EQ(matte(54, 30), 1);
}

}  // namespace
}  // namespace mixrig::test
