// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "host/render/cpu/color_lanes.h"

namespace mixrig::test {
namespace {

using render::cpu::ColorLanes;
using render::cpu::FloatLanes;
using render::cpu::kLanes;
using render::cpu::Rgbx16;

TEST(Lanes, logarithm_is_that_of_the_library) {
  for (double exponent = -30; exponent < 30; exponent += 0.37)
    for (int step = 0; step < 50; ++step) {
      FloatLanes f;
      for (int i = 0; i < kLanes; ++i)
        f[i] = static_cast<float>(std::pow(10, exponent) * (1 + 0.013 * (kLanes * step + i)));
      const FloatLanes found = render::cpu::log(f);
      for (int i = 0; i < kLanes; ++i) {
        const double truth = std::log(static_cast<double>(f[i]));
        ASSERT_NEAR(found[i], truth, 2e-7 * std::max(1.0, std::abs(truth))) << f[i];
      }
    }
  EXPECT_EQ(render::cpu::log(FloatLanes{} + 1)[0], 0);
}

TEST(Lanes, bits_tell_which_lanes_are_true) {
  for (int lane = 0; lane < kLanes; ++lane) {
    FloatLanes f{};
    f[lane] = 1;
    EXPECT_EQ(render::cpu::bits_of(f > 0), 1U << lane);
    EXPECT_TRUE(render::cpu::any(f > 0));
    EXPECT_EQ(render::cpu::least_of(-f), -1);
  }
  EXPECT_FALSE(render::cpu::any(FloatLanes{} > 0));
}

TEST(Lanes, inverse_is_that_of_a_division) {
  for (const float first : {1e-6F, 0.3F, 7.0F, 1e6F}) {
    const FloatLanes f = first * (1 + 0.37F * render::cpu::lane_numbers());
    const FloatLanes found = render::cpu::inverse(f);
    for (int i = 0; i < kLanes; ++i) EXPECT_NEAR(found[i] * f[i], 1, 1e-6);
  }
}

TEST(Lanes, bytes_are_read_at_any_offset) {
  std::vector<std::uint8_t> bytes(3 * kLanes + 1);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(7 * i + 1);
  const auto offset = render::cpu::truncate(3 * render::cpu::lane_numbers());
  const auto found = render::cpu::gather_bytes(bytes.data(), offset);
  for (int i = 0; i < kLanes; ++i)
    EXPECT_EQ(found[i] & 255, bytes[static_cast<std::size_t>(3 * i)]) << i;
}

/// Tests every offset, also those at which a register reaches over the ends of the row.
TEST(Lanes, pixels_of_a_row_are_those_at_its_ends_beyond_them) {
  std::mt19937 random(1);
  for (const int width : {1, 3, kLanes, 2 * kLanes + 5}) {
    std::vector<Rgbx16> plate(static_cast<std::size_t>(width));
    std::vector<Rgbf> learned(plate.size());
    std::vector<std::uint8_t> bytes(plate.size());
    for (std::size_t i = 0; i < plate.size(); ++i) {
      const auto next = [&] { return static_cast<std::uint16_t>(random()); };
      plate[i] = {next(), next(), next(), next()};
      learned[i] = {static_cast<float>(next()), static_cast<float>(next()),
                    static_cast<float>(next())};
      bytes[i] = static_cast<std::uint8_t>(next());
    }
    for (int x = -3; x < width + 2; ++x) {
      const ColorLanes p = render::cpu::color_lanes(plate.data(), x, width);
      const ColorLanes b = render::cpu::color_lanes(learned.data(), x, width);
      const auto c = render::cpu::byte_lanes(bytes.data(), x, width);
      for (int i = 0; i < kLanes; ++i) {
        const auto at = static_cast<std::size_t>(std::clamp(x + i, 0, width - 1));
        ASSERT_FLOAT_EQ(p.r[i], static_cast<float>(plate[at].r) / 65535) << x << " + " << i;
        ASSERT_FLOAT_EQ(p.g[i], static_cast<float>(plate[at].g) / 65535);
        ASSERT_FLOAT_EQ(p.b[i], static_cast<float>(plate[at].b) / 65535);
        ASSERT_EQ(b.r[i], learned[at].r);
        ASSERT_EQ(b.g[i], learned[at].g);
        ASSERT_EQ(b.b[i], learned[at].b);
        ASSERT_EQ(c[i], bytes[at]);
      }
    }
  }
}

}  // namespace
}  // namespace mixrig::test
