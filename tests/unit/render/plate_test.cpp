// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/plate.h"

#include <cmath>

#include "hal/base/srgb.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

using render::cpu::Rgbx16;

Image<Rgbx16> draw(const render::CompositorSetup& setup, const Image<Rgb8>& plate) {
  const render::Tables tables = render::make_tables(setup);
  render::cpu::PlateScratch scratch(tables);
  Image<Rgbx16> out(tables.view_size);
  Crew crew(2);
  render::cpu::draw_plate(crew, plate, scratch, out);
  return out;
}

TEST(Srgb, every_byte_comes_back_and_all_values_round_to_the_nearest) {
  const auto& linear = render::cpu::srgb_to_linear();
  const auto& srgb = srgb_bytes_of_linear16();
  for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(srgb[linear[i]], i);
  EXPECT_EQ(linear[255], 65535);
  EXPECT_EQ(srgb[0], 0);
  // 50 % grey of light is sRGB 187.5: 188 by the standard's curve.
  EXPECT_EQ(srgb[32768], 188);
}

TEST(Plate, ideal_lens_copies_in_linear_light) {
  const auto plate = make_image<Rgb8>({5, 3}, [](int x, int y) {
    return Rgb8{static_cast<std::uint8_t>(40 * x), static_cast<std::uint8_t>(90 * y), 255};
  });
  const auto out = draw(plain_setup({5, 3}, 10, {4, 4}, 4), plate);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      EXPECT_EQ(out.at(x, y).r, render::cpu::srgb_to_linear()[plate.at(x, y).r]);
      EXPECT_EQ(out.at(x, y).g, render::cpu::srgb_to_linear()[plate.at(x, y).g]);
      EXPECT_EQ(out.at(x, y).b, 65535);
    }
}

TEST(Plate, half_a_pixel_off_is_the_mean_of_light_and_the_border_is_clamped) {
  render::CompositorSetup setup = plain_setup({4, 1}, 10, {4, 4}, 4);
  setup.view.cx_px -= 0.5;  // view pixel x looks at plate pixel x + 0.5
  const auto plate = make_image<Rgb8>({4, 1}, [](int x, int) {
    return x % 2 ? Rgb8{255, 255, 255} : Rgb8{0, 0, 0};
  });
  const auto out = draw(setup, plate);
  for (int x = 0; x < 3; ++x) EXPECT_NEAR(out.at(x, 0).g, 32768, 1);
  EXPECT_EQ(out.at(3, 0).g, 65535);
}

TEST(Plate, vignetting_is_taken_out_as_far_as_white) {
  render::CompositorSetup setup = plain_setup({33, 25}, 20, {4, 4}, 4);
  setup.vignetting = {0.4, 0.2};
  const Image<Rgb8> plate({33, 25}, Rgb8{100, 30, 250});
  const auto out = draw(setup, plate);
  const auto& linear = render::cpu::srgb_to_linear();
  for (const auto& [x, y] : {std::pair{16, 12}, {0, 0}, {32, 3}, {20, 24}}) {
    const double dx = x - setup.target.pinhole.cx_px, dy = y - setup.target.pinhole.cy_px;
    const double r2 = (dx * dx + dy * dy) / (16.5 * 16.5 + 12.5 * 12.5);
    const double gain = std::exp(0.4 * r2 + 0.2 * r2 * r2);
    EXPECT_NEAR(out.at(x, y).r, gain * linear[100], 0.0003 * linear[100] + 1);
    EXPECT_NEAR(out.at(x, y).g, gain * linear[30], 0.0003 * linear[30] + 1);
    EXPECT_NEAR(out.at(x, y).b, std::min(65535.0, gain * linear[250]), 0.0003 * 65535);
  }
  EXPECT_EQ(out.at(0, 0).b, 65535);
}

TEST(Plate, lens_is_followed) {
  render::CompositorSetup setup = plain_setup({33, 33}, 20, {4, 4}, 4);
  setup.target.lens = geometry::Lens({-0.2, 0, 0, 0, 0, 0, 0, 0});
  // Light grows with the column, so that a sample shows where it was taken.
  const auto& srgb = srgb_bytes_of_linear16();
  const auto plate = make_image<Rgb8>({33, 33}, [&](int x, int) {
    const std::uint8_t c = srgb[static_cast<std::size_t>(65535 * x / 32)];
    return Rgb8{c, c, c};
  });
  const auto out = draw(setup, plate);
  for (const int x : {2, 10, 16, 25, 30}) {
    const double ray = (x - 16) / 20.0;
    const double column = 20 * ray * (1 - 0.2 * ray * ray) + 16;
    EXPECT_NEAR(out.at(x, 16).r / 65535.0 * 32, column, 0.15) << x;
  }
}

TEST(Plate, picture_of_one_pixel_through_a_lens) {
  render::CompositorSetup setup = plain_setup({1, 1}, 10, {4, 4}, 4);
  setup.view.cx_px += 3;
  const auto out = draw(setup, Image<Rgb8>({1, 1}, Rgb8{255, 0, 255}));
  EXPECT_EQ(out.at(0, 0).r, 65535);
  EXPECT_EQ(out.at(0, 0).g, 0);
}

}  // namespace
}  // namespace mixrig::test
