// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/plate_pass.h"

#include "tests/gl/dropped.h"
#include "tests/gl/gl_fixture.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

class PlatePassTest : public GlTest {};

/// A picture of 20 x 17 pixels: its rows of 60 bytes fit no 4- or 8-byte rule by chance at stride
/// 21.
Image<Rgb8> steps() {
  return make_image<Rgb8>({20, 17}, [](int x, int y) {
    return Rgb8{static_cast<std::uint8_t>(12 * x), static_cast<std::uint8_t>(15 * y), 77};
  });
}

TEST_F(PlatePassTest, samples_in_linear_light_and_clamps_at_the_border) {
  render::Tables tables;
  tables.plate_size = {20, 17};
  tables.view_size = {16, 16};
  tables.plate_px = make_image<glm::vec2>({16, 16}, [](int x, int y) {
    return y == 0 ? glm::vec2(-5, -9) : y == 1 ? glm::vec2(40, 99) : glm::vec2(x, y);
  });
  tables.plate_px.at(5, 5) = {10.5F, 4};
  auto pass = PlatePass::create(tables);
  ASSERT_TRUE(pass) << pass.error().context;
  const Image<Rgb8> plate = steps();
  ASSERT_TRUE(pass->upload_plate(plate));
  pass->draw();
  const auto view = read(pass->in_view());
  EXPECT_EQ(glm::round(255.0F * view.at(3, 7)), glm::vec4(36, 105, 77, 255));
  EXPECT_EQ(glm::round(255.0F * view.at(9, 0)), glm::vec4(0, 0, 77, 255));
  EXPECT_EQ(glm::round(255.0F * view.at(9, 1)), glm::vec4(228, 240, 77, 255));
  // Half way between sRGB 120 and 132, linear 0.18782 and 0.23074: their mean is sRGB 126.2.
  EXPECT_NEAR(255 * view.at(5, 5).r, 126.2F, 0.6F);
}

TEST_F(PlatePassTest, mean_of_black_and_white_is_bright) {
  render::Tables tables;
  tables.plate_size = {2, 1};
  tables.view_size = {1, 1};
  tables.plate_px = make_image<glm::vec2>({1, 1}, [](int, int) { return glm::vec2(0.5F, 0); });
  auto pass = PlatePass::create(tables);
  ASSERT_TRUE(pass);
  const auto plate = make_image<Rgb8>({2, 1}, [](int x, int) {
    return x == 0 ? Rgb8{} : Rgb8{255, 255, 255};
  });
  ASSERT_TRUE(pass->upload_plate(plate));
  pass->draw();
  EXPECT_NEAR(255 * read(pass->in_view()).at(0, 0).r, 188, 1);  // linear 0.5, not byte 128
}

TEST_F(PlatePassTest, multiplies_light_against_vignetting) {
  render::Tables tables;
  tables.plate_size = tables.view_size = {2, 1};
  tables.plate_px = make_image<glm::vec2>({2, 1}, [](int x, int) { return glm::vec2(x, 0); });
  tables.plate_gain = make_image<float>({2, 1}, [](int x, int) { return x == 0 ? 1.0F : 1.5F; });
  auto pass = PlatePass::create(tables);
  ASSERT_TRUE(pass);
  ASSERT_TRUE(pass->upload_plate(Image<Rgb8>({2, 1}, Rgb8{120, 60, 240})));
  pass->draw();
  const auto view = read(pass->in_view());
  EXPECT_EQ(glm::round(255.0F * view.at(0, 0)), glm::vec4(120, 60, 240, 255));
  // sRGB 120 and 60 are linear 0.18782 and 0.04519; 1.5 times that is sRGB 144.7 and 73.6.
  EXPECT_EQ(glm::round(255.0F * view.at(1, 0)), glm::vec4(145, 74, 255, 255));
}

TEST_F(PlatePassTest, second_round_of_buffers_holds_its_own_pictures) {
  render::Tables tables;
  tables.plate_size = tables.view_size = {2, 1};
  tables.plate_is_view = true;
  auto pass = PlatePass::create(tables);
  ASSERT_TRUE(pass);
  for (std::uint8_t i = 1; i < 9; ++i) {
    ASSERT_TRUE(pass->upload_plate(Image<Rgb8>({2, 1}, Rgb8{i, 60, 240})));
    EXPECT_EQ(glm::round(255.0F * read(pass->in_view()).at(1, 0)), glm::vec4(i, 60, 240, 255));
  }
}

TEST_F(PlatePassTest, keeps_the_last_view) {
  render::Tables tables;
  tables.plate_size = tables.view_size = {2, 1};
  tables.plate_px = make_image<glm::vec2>({2, 1}, [](int x, int) { return glm::vec2(x, 0); });
  for (const bool is_view : {true, false}) {
    tables.plate_is_view = is_view;
    auto pass = PlatePass::create(tables, true);
    ASSERT_TRUE(pass);
    for (std::uint8_t i = 1; i < 5; ++i) {
      pass->swap();
      ASSERT_TRUE(pass->upload_plate(Image<Rgb8>({2, 1}, Rgb8{i, 60, 240})));
      if (pass->draws()) pass->draw();
      EXPECT_EQ(std::lround(255.0F * read(pass->in_view()).at(1, 0).r), i);
      if (i > 1) {
        EXPECT_EQ(std::lround(255.0F * read(pass->last_in_view()).at(1, 0).r), i - 1);
      }
    }
  }
}

TEST_F(PlatePassTest, drops_what_its_target_held) {
  render::Tables tables;
  tables.plate_size = tables.view_size = {2, 1};
  tables.plate_px = make_image<glm::vec2>({2, 1}, [](int x, int) { return glm::vec2(x, 0); });
  auto pass = PlatePass::create(tables);
  ASSERT_TRUE(pass);
  const int before = dropped_count();
  pass->draw();
  EXPECT_EQ(dropped_count() - before, 1);
}

TEST_F(PlatePassTest, draws_nothing_without_a_lens) {
  render::Tables tables;
  tables.plate_size = tables.view_size = {20, 17};
  tables.plate_is_view = true;
  auto pass = PlatePass::create(tables);
  ASSERT_TRUE(pass);
  EXPECT_FALSE(pass->draws());
}

}  // namespace
}  // namespace mixrig::test
