// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/plate_pass.h"

#include <cmath>

#include "tests/gl/dropped.h"
#include "tests/gl/gl_fixture.h"

namespace mixrig::test {
namespace {

using namespace render::gles;

class PlatePassTest : public GlTest {};

/// A view at whose pixel p the plate shows its pixel scale * p + shift.
render::CompositorSetup seen(Size view, Size plate, double scale_x, double scale_y,
                             const Eigen::Vector2d& shift) {
  render::CompositorSetup setup;
  setup.view = {view, 1, 1, 0, 0};
  setup.target.pinhole = {plate, scale_x, scale_y, shift.x(), shift.y()};
  return setup;
}

/// A picture of 20 x 17 pixels: its rows of 60 bytes fit no 4- or 8-byte rule by chance at stride
/// 21.
Image<Rgb8> steps() {
  return make_image<Rgb8>({20, 17}, [](int x, int y) {
    return Rgb8{static_cast<std::uint8_t>(12 * x), static_cast<std::uint8_t>(15 * y), 77};
  });
}

TEST_F(PlatePassTest, samples_in_linear_light_and_clamps_at_the_border) {
  const auto at = [&](double x, double y) {
    auto pass = PlatePass::create(seen({1, 1}, {20, 17}, 1, 1, {x, y}), false);
    EXPECT_TRUE(pass && pass->upload_plate(steps()));
    pass->draw();
    return glm::vec4(255.0F * read(pass->in_view()).at(0, 0));
  };
  EXPECT_EQ(glm::round(at(3, 7)), glm::vec4(36, 105, 77, 255));
  EXPECT_EQ(glm::round(at(-5, -9)), glm::vec4(0, 0, 77, 255));
  EXPECT_EQ(glm::round(at(40, 99)), glm::vec4(228, 240, 77, 255));
  // Half way between sRGB 120 and 132, linear 0.18782 and 0.23074: their mean is sRGB 126.2.
  EXPECT_NEAR(at(10.5, 4).r, 126.2F, 0.6F);
}

/// The picture holds its own pixel positions, so that the drawn view is the map, to a fifth of a
/// pixel.
TEST_F(PlatePassTest, maps_each_pixel_through_the_lens) {
  const Size size{64, 48};
  render::CompositorSetup setup;
  setup.view = {size, 50, 52, 31, 23.5};
  setup.target = {{{52, 39}, 38, 39, 26.2, 19.3},
                  geometry::Lens({-0.3, 0.1, 0.004, -0.006, -0.02, 0.01, 0.02, -0.003})};
  auto pass = PlatePass::create(setup, false);
  ASSERT_TRUE(pass) << pass.error().context;
  ASSERT_TRUE(pass->upload_plate(make_image<Rgb8>({52, 39}, [](int x, int y) {
    return Rgb8{static_cast<std::uint8_t>(5 * x), static_cast<std::uint8_t>(5 * y), 0};
  })));
  pass->draw();
  const auto view = read(pass->in_view());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto px = setup.target.project({(x - 31) / 50.0, (y - 23.5) / 52.0, 1});
      ASSERT_TRUE(px) << x << "," << y;
      EXPECT_NEAR(255 * view.at(x, y).r, 5 * std::clamp(px->x(), 0.0, 51.0), 1) << x << "," << y;
      EXPECT_NEAR(255 * view.at(x, y).g, 5 * std::clamp(px->y(), 0.0, 38.0), 1) << x << "," << y;
    }
}

TEST_F(PlatePassTest, mean_of_black_and_white_is_bright) {
  auto pass = PlatePass::create(seen({1, 1}, {2, 1}, 1, 1, {0.5, 0}), false);
  ASSERT_TRUE(pass);
  const auto plate = make_image<Rgb8>({2, 1}, [](int x, int) {
    return x == 0 ? Rgb8{} : Rgb8{255, 255, 255};
  });
  ASSERT_TRUE(pass->upload_plate(plate));
  pass->draw();
  EXPECT_NEAR(255 * read(pass->in_view()).at(0, 0).r, 188, 1);  // linear 0.5, not byte 128
}

TEST_F(PlatePassTest, multiplies_light_against_vignetting) {
  render::CompositorSetup setup = seen({2, 1}, {2, 1}, 1, 1, {0, 0});
  // The second pixel is a pixel off the principal point: its r^2 is 4 / 5.
  setup.vignetting.a = std::log(1.5) / 0.8;
  auto pass = PlatePass::create(setup, false);
  ASSERT_TRUE(pass);
  ASSERT_TRUE(pass->upload_plate(Image<Rgb8>({2, 1}, Rgb8{120, 60, 240})));
  pass->draw();
  const auto view = read(pass->in_view());
  EXPECT_EQ(glm::round(255.0F * view.at(0, 0)), glm::vec4(120, 60, 240, 255));
  // sRGB 120 and 60 are linear 0.18782 and 0.04519; 1.5 times that is sRGB 144.7 and 73.6.
  EXPECT_EQ(glm::round(255.0F * view.at(1, 0)), glm::vec4(145, 74, 255, 255));
}

TEST_F(PlatePassTest, second_round_of_buffers_holds_its_own_pictures) {
  auto pass = PlatePass::create(seen({2, 1}, {2, 1}, 1, 1, {0, 0}), true);
  ASSERT_TRUE(pass);
  for (std::uint8_t i = 1; i < 9; ++i) {
    ASSERT_TRUE(pass->upload_plate(Image<Rgb8>({2, 1}, Rgb8{i, 60, 240})));
    EXPECT_EQ(glm::round(255.0F * read(pass->in_view()).at(1, 0)), glm::vec4(i, 60, 240, 255));
  }
}

TEST_F(PlatePassTest, keeps_the_last_view) {
  const Image<float> background({2, 1}, 3.0F);
  render::CompositorSetup setup = seen({2, 1}, {2, 1}, 1, 1, {0, 0});
  setup.background.depth_m = background;
  for (const bool is_view : {true, false}) {
    auto pass = PlatePass::create(setup, is_view);
    ASSERT_TRUE(pass);
    for (std::uint8_t i = 1; i < 5; ++i) {
      pass->swap();
      ASSERT_TRUE(pass->upload_plate(Image<Rgb8>({2, 1}, Rgb8{i, 60, 240})));
      if (pass->draws()) pass->draw();
      EXPECT_EQ(std::lround(255.0F * read(pass->in_view()).at(1, 0).r), i);
      if (i == 1) continue;
      EXPECT_EQ(std::lround(255.0F * read(pass->last_in_view()).at(1, 0).r), i - 1);
    }
  }
}

TEST_F(PlatePassTest, drops_what_its_target_held) {
  auto pass = PlatePass::create(seen({2, 1}, {2, 1}, 1, 1, {0, 0}), false);
  ASSERT_TRUE(pass);
  const int before = dropped_count();
  pass->draw();
  EXPECT_EQ(dropped_count() - before, 1);
}

TEST_F(PlatePassTest, draws_nothing_without_a_lens) {
  auto pass = PlatePass::create(seen({20, 17}, {20, 17}, 1, 1, {0, 0}), true);
  ASSERT_TRUE(pass);
  EXPECT_FALSE(pass->draws());
}

}  // namespace
}  // namespace mixrig::test
