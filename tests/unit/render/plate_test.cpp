// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/plate/plate.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "hal/base/srgb.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

using render::cpu::Rgbx16;

Image<Rgbx16> draw(const render::CompositorSetup& setup, const Image<Rgb8>& plate) {
  const render::Tables tables = render::make_tables(setup);
  render::cpu::PlateScratch scratch(tables, 2);
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

TEST(Srgb, rows_are_encoded_and_decoded_as_the_tables_say) {
  const auto& srgb = srgb_bytes_of_linear16();
  // Every value in every channel, in rows whose ends do not fill a register.
  for (const int width : {65536, 1, 5, 6, 13}) {
    std::vector<Rgbx16> linear(static_cast<std::size_t>(width));
    for (int x = 0; x < width; ++x) {
      const auto at = [&](int shift) { return static_cast<std::uint16_t>(x + shift); };
      linear[static_cast<std::size_t>(x)] = {at(0), at(20000), at(41000), 0};
    }
    std::vector<Rgb8> bytes(static_cast<std::size_t>(width) + 1, Rgb8{1, 2, 3});
    render::cpu::encode_row(linear.data(), width, bytes.data());
    int wrong = 0;
    for (std::size_t x = 0; x < linear.size(); ++x)
      wrong += bytes[x] != Rgb8{srgb[linear[x].r], srgb[linear[x].g], srgb[linear[x].b]};
    EXPECT_EQ(wrong, 0) << width;
    EXPECT_EQ(bytes.back(), (Rgb8{1, 2, 3})) << width << ": nothing past the row is written";
  }
  const auto& to_linear = render::cpu::srgb_to_linear();
  for (std::size_t i = 0; i < 256; ++i) {
    const Rgb8 bytes{static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(255 - i), 7};
    Rgbx16 linear{0, 0, 0, 9};
    render::cpu::decode_row(&bytes, 1, &linear);
    EXPECT_EQ(linear.r, to_linear[i]);
    EXPECT_EQ(linear.g, to_linear[255 - i]);
    EXPECT_EQ(linear.b, to_linear[7]);
    EXPECT_EQ(linear.x, 0);
  }
}

TEST(Plate, samples_of_a_register_are_those_of_a_pixel) {
  constexpr int kWidth = 64, kHeight = 8;
  std::mt19937 random(1);
  std::uniform_int_distribution<int> value(0, 65535), fraction(0, 256);
  const auto extreme = [&] {  // a third is least or most
    const int v = value(random);
    return static_cast<std::uint16_t>(v % 6 == 0 ? 0 : v % 6 == 1 ? 65535 : v);
  };
  std::vector<Rgbx16> image(static_cast<std::size_t>(kWidth) * kHeight);
  for (Rgbx16& p : image) p = {extreme(), extreme(), extreme(), 0};
  int wrong = 0;
  for (int round = 0; round < 2000; ++round) {
    std::array<render::cpu::Tap, render::cpu::kBlendPx> taps;
    for (render::cpu::Tap& tap : taps)
      tap = {static_cast<std::uint32_t>(value(random) % (kWidth * (kHeight - 1) - 1)),
             static_cast<std::uint16_t>(fraction(random)),
             static_cast<std::uint16_t>(fraction(random))};
    std::array<Rgbx16, render::cpu::kBlendPx> out;
    render::cpu::blend_run(taps.data(), image.data(), kWidth, out.data());
    for (std::size_t i = 0; i < taps.size(); ++i) {
      const Rgbx16* const p = &image[taps[i].offset];
      // Exact values with their rounding: half goes down.
      const auto expected = [&](auto channel) {
        const std::uint64_t fx = taps[i].fraction_x, fy = taps[i].fraction_y;
        const std::uint64_t sum =
            (channel(p[0]) * (256 - fx) + channel(p[1]) * fx) * (256 - fy) +
            (channel(p[kWidth]) * (256 - fx) + channel(p[kWidth + 1]) * fx) * fy;
        return static_cast<std::uint16_t>((sum + 0x7FFF) >> 16);
      };
      wrong += out[i].r != expected([](Rgbx16 c) -> std::uint64_t { return c.r; });
      wrong += out[i].g != expected([](Rgbx16 c) -> std::uint64_t { return c.g; });
      wrong += out[i].b != expected([](Rgbx16 c) -> std::uint64_t { return c.b; });
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Plate, its_bytes_are_those_of_its_light) {
  const auto& srgb = srgb_bytes_of_linear16();
  for (const bool lens : {false, true}) {
    render::CompositorSetup setup = plain_setup({71, 67}, 40, {4, 4}, 4);
    if (lens) setup.target.lens = geometry::Lens({-0.2, 0.05, 0.001, 0, 0, 0, 0, 0});
    if (lens) setup.vignetting = {0.4, 0.2};
    const auto plate = make_image<Rgb8>({71, 67}, [](int x, int y) {
      return Rgb8{static_cast<std::uint8_t>(37 * x + 11 * y), static_cast<std::uint8_t>(5 * y),
                  static_cast<std::uint8_t>(x * y)};
    });
    const render::Tables tables = render::make_tables(setup);
    render::cpu::PlateScratch scratch(tables, 2);
    Image<Rgbx16> out(tables.view_size);
    Image<Rgb8> color(tables.view_size);
    Crew crew(2);
    render::cpu::draw_plate(crew, plate, scratch, out, &color);
    int wrong = 0;
    for (int y = 0; y < 67; ++y)
      for (int x = 0; x < 71; ++x) {
        const Rgbx16 c = out.at(x, y);
        wrong += color.at(x, y) != Rgb8{srgb[c.r], srgb[c.g], srgb[c.b]};
      }
    EXPECT_EQ(wrong, 0) << "lens: " << lens;
  }
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
