// SPDX-License-Identifier: Apache-2.0
// The target camera against closed forms: photon transfer, demosaicing, circles of confusion,
// falloff, rows in time, a turned camera.
#include "studio/sensors/color_camera.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "studio/sensors/shutter.h"
#include "studio/sensors/warp.h"
#include "studio/studio.h"

namespace mixrig::studio {
namespace {

Optics pinhole(Size size, double f_px) {
  return {size, f_px, f_px, 0.5 * (size.width - 1), 0.5 * (size.height - 1), {}};
}

struct Spread {
  double mean = 0, variance = 0;
};

/// Electrons of the green pixels of an evenly lit picture.
Spread green_electrons(float level, const ColorSensor& sensor, Crew& crew) {
  const Image<Rgbf> light({256, 256}, {level, level, level});
  Image<float> raw;
  expose(sensor, light, 77, NormalTable(), crew, raw);
  Spread spread;
  int count = 0;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x)
      if (bayer_channel(x, y) == 1) {
        const double e =
            static_cast<double>(raw.at(x, y)) * static_cast<double>(sensor.full_well_e);
        spread.mean += e, spread.variance += e * e, ++count;
      }
  spread.mean /= count;
  spread.variance = spread.variance / count - spread.mean * spread.mean;
  return spread;
}

// Photon transfer: variance = read^2 + converter step^2 / 12 + mean, in electrons.
TEST(ColorCamera, variance_is_linear_in_the_signal) {
  Crew crew(2);
  const ColorSensor sensor;
  const double step = sensor.full_well_e / sensor.levels;
  for (const float level : {0.0F, 0.02F, 0.1F, 0.3F, 0.7F}) {
    const Spread s = green_electrons(level, sensor, crew);
    const double expected = 64 + step * step / 12 + 12000.0 * static_cast<double>(level);
    // A variance of n normal values scatters by sqrt(2 / n) = 0.8 % of itself.
    EXPECT_NEAR(s.variance, expected, 0.035 * expected) << level;
    EXPECT_NEAR(s.mean, 12000.0 * static_cast<double>(level),
                4 * std::sqrt(expected / 32768) + 0.1);
  }
  EXPECT_LT(green_electrons(1.5F, sensor, crew).variance, 1) << "saturated";
}

TEST(ColorCamera, demosaicing_keeps_ramps_of_any_colour_and_spoils_edges_of_one) {
  Image<float> raw({24, 20});
  const auto ramp = [](int x, int y, int c) {
    return 0.1F + 0.01F * static_cast<float>(x) + 0.02F * static_cast<float>(y) +
           0.05F * static_cast<float>(c);
  };
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) raw.at(x, y) = ramp(x, y, bayer_channel(x, y));
  for (int y = 2; y < 18; ++y)
    for (int x = 2; x < 22; ++x) {
      const Rgbf c = demosaic_at(raw, x, y);
      EXPECT_NEAR(c.r, ramp(x, y, 0), 1e-5F) << x << ' ' << y;
      EXPECT_NEAR(c.g, ramp(x, y, 1), 1e-5F);
      EXPECT_NEAR(c.b, ramp(x, y, 2), 1e-5F);
    }
  // A red step on black: green and blue are zero, but the filters make some up.
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) raw.at(x, y) = x >= 12 && bayer_channel(x, y) == 0 ? 1.0F : 0.0F;
  float most = 0;
  for (int x = 2; x < 22; ++x) most = std::max(most, std::abs(demosaic_at(raw, x, 10).g));
  EXPECT_GT(most, 0.1F);
}

// The filters see red, green and blue as the sensor does: unequal, unless they are balanced before.
TEST(ColorCamera, a_grey_step_stays_grey) {
  Crew crew(1);
  Realism realism;
  realism.mosaic = true;
  const Optics optics = pinhole({64, 8}, 60);
  ColorCamera camera(optics, realism, 1);
  Image<Rgb8> picture;
  double worst = 0;
  for (int frame = 0; frame < 20; ++frame) {
    Image<Rgbf> light(optics.size_px);
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 64; ++x)
        light.at(x, y) = x < 32 ? Rgbf{0.2F, 0.2F, 0.2F} : Rgbf{0.8F, 0.8F, 0.8F};
    camera.develop(light, Image<float>(optics.size_px, 3.0F), frame, 0, crew, picture);
    for (int x = 12; x < 52; ++x)
      worst = std::max(
          worst, std::abs(0.5 * (picture.at(x, 4).r + picture.at(x, 4).b) - picture.at(x, 4).g));
  }
  // A filter across the step makes up to a quarter of it (Malvar et al.: 1/8 of twice the step).
  EXPECT_LT(worst, 40);
}

TEST(ColorCamera, chroma_is_that_of_pairs_and_luma_stays) {
  Crew crew(1);
  Image<Rgb8> picture({4, 1});
  picture.at(0, 0) = {200, 40, 40}, picture.at(1, 0) = {40, 40, 200};
  picture.at(2, 0) = {90, 90, 90}, picture.at(3, 0) = {120, 120, 120};
  const auto luma = [](const Rgb8& c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b; };
  Image<Rgb8> halved = picture;
  halve_chroma(halved, crew);
  for (int x = 0; x < 4; ++x) EXPECT_NEAR(luma(halved.at(x, 0)), luma(picture.at(x, 0)), 1.5) << x;
  const Rgb8 a = halved.at(0, 0), b = halved.at(1, 0);
  EXPECT_NEAR(a.r - luma(a), b.r - luma(b), 2);
  EXPECT_NEAR(a.b - luma(a), b.b - luma(b), 2);
  EXPECT_EQ(halved.at(2, 0), picture.at(2, 0));
  EXPECT_EQ(halved.at(3, 0), picture.at(3, 0));
}

// A disc of diameter D has a variance of D^2 / 16 along each axis.
TEST(ColorCamera, a_point_out_of_focus_is_a_disc_of_the_thin_lens) {
  Crew crew(2);
  const ColorSensor sensor;
  const Size size{41, 41};
  for (const float z : {0.4F, 0.6F, 1.0F}) {
    const double f_px = 1200;
    const double diameter = 0.0046 * f_px * std::abs(1 / static_cast<double>(z) - 1 / 2.8);
    ASSERT_NEAR(blur_circle_px(sensor, 1200, z), diameter, 1e-4);
    Image<Rgbf> light(size), blurred;
    light.at(20, 20) = {1, 1, 1};
    defocus(sensor, static_cast<float>(f_px), light, Image<float>(size, z), crew, blurred);
    double sum = 0, variance = 0;
    for (int y = 0; y < 41; ++y)
      for (int x = 0; x < 41; ++x) {
        sum += static_cast<double>(blurred.at(x, y).g);
        variance += static_cast<double>(blurred.at(x, y).g) * (x - 20) * (x - 20);
      }
    EXPECT_NEAR(sum, 1, 1e-3) << "light is neither lost nor made";
    EXPECT_NEAR(variance, diameter * diameter / 16, 0.12 * diameter * diameter / 16 + 0.1) << z;
  }
}

TEST(ColorCamera, a_sharp_foreground_stays_sharp_before_a_blurred_background) {
  Crew crew(1);
  const ColorSensor sensor;
  Image<Rgbf> light({40, 9}), blurred;
  Image<float> z({40, 9});
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 40; ++x) {
      z.at(x, y) = x < 20 ? 2.8F : 100.0F;  // the left half is in focus
      light.at(x, y) = x < 20 ? Rgbf{} : Rgbf{1, 1, 1};
    }
  defocus(sensor, 6000, light, z, crew, blurred);
  EXPECT_EQ(blurred.at(19, 4).g, 0);
  EXPECT_EQ(blurred.at(10, 4).g, 0);
  EXPECT_NEAR(blurred.at(30, 4).g, 1, 1e-5F);
}

TEST(ColorCamera, corners_are_darker_by_the_power_of_the_cosine) {
  Crew crew(1);
  Realism realism;
  realism.vignetting = true;
  const Optics optics = pinhole({161, 121}, 120);
  ColorCamera camera(optics, realism, 1);
  Image<Rgb8> picture;
  const auto mean_at = [&](int x, int y) {  // linear; over frames, since there is noise
    double sum = 0;
    for (int frame = 0; frame < 40; ++frame) {
      Image<Rgbf> light(optics.size_px, {0.5F, 0.5F, 0.5F});
      camera.develop(light, Image<float>(optics.size_px, 3.0F), frame, 0, crew, picture);
      const double c = picture.at(x, y).g / 255.0;
      sum += std::pow((c + 0.055) / 1.055, 2.4);
    }
    return sum / 40;
  };
  const double cosine = 120 / std::sqrt(120.0 * 120 + 80 * 80 + 60 * 60);
  EXPECT_NEAR(mean_at(80, 60), 0.5, 0.005);
  EXPECT_NEAR(mean_at(0, 0), 0.5 * std::pow(cosine, 1.6), 0.005);
}

TEST(ColorCamera, gains_start_at_one_and_drift_slowly) {
  double most = 0;
  for (unsigned seed = 1; seed < 20; ++seed) {
    EXPECT_EQ(gain_at(seed, 0).exposure, 1);
    for (int i = 0; i < 250; ++i) {
      const Gain a = gain_at(seed, i / 25.0), b = gain_at(seed, (i + 1) / 25.0);
      EXPECT_LE(std::abs(std::log2(a.exposure)), 0.12F);
      EXPECT_LE(std::abs(a.red - 1), 0.03F);
      EXPECT_LE(std::abs(b.exposure - a.exposure), 0.01F);
      most = std::max(most, static_cast<double>(std::abs(std::log2(a.exposure))));
    }
  }
  EXPECT_GT(most, 0.06);
}

// Mean and variance in time of a box of length T are its middle and T^2 / 12.
TEST(Shutter, rows_are_exposed_for_a_time_at_a_time) {
  const Shutter shutter(101, 8e-3, 12e-3);
  for (const int row : {0, 13, 50, 77, 100}) {
    double sum = 0, mean = 0, square = 0;
    for (int i = 0; i < shutter.slices(); ++i) {
      const double w = static_cast<double>(shutter.weight(row, i)), t = shutter.time_s(i);
      sum += w, mean += w * t, square += w * t * t;
    }
    const double expected = (row / 100.0 - 0.5) * 12e-3;
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_NEAR(mean, expected, 1e-4) << row;
    const double own = square - mean * mean;  // slices of 2 ms stand for their middles
    EXPECT_NEAR(own, 64e-6 / 12, 4e-6 / 6) << row;
  }
}

TEST(Shutter, without_time_all_rows_are_one_instant) {
  const Shutter shutter(10, 0, 0);
  ASSERT_EQ(shutter.slices(), 1);
  EXPECT_EQ(shutter.time_s(0), 0);
  for (int y = 0; y < 10; ++y) EXPECT_EQ(shutter.weight(y, 0), 1);
}

TEST(Warp, a_turned_camera_moves_the_axis_by_f_tan) {
  const Optics optics = pinhole({320, 240}, 300);
  const RayGrid rays(optics);
  const double angle = 0.02;
  const geometry::Pose mid_from_then{
      Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())), {0, 0, 0}};
  const Eigen::Vector2f at = seen_from(rays, optics, mid_from_then, {159.5F, 119.5F}, 4.0F);
  EXPECT_NEAR(at.x(), 159.5 + 300 * std::tan(angle), 1e-3);
  EXPECT_NEAR(at.y(), 119.5, 1e-3);
  const geometry::Pose moved{Eigen::Quaterniond::Identity(), {0.1, 0, 0}};
  EXPECT_NEAR(seen_from(rays, optics, moved, {159.5F, 119.5F}, 4.0F).x(), 159.5 + 300 * 0.025,
              1e-3);
}

TEST(Realism, switches_have_names_and_a_wrong_one_is_one_line) {
  EXPECT_EQ(names_of({}), "plain");
  EXPECT_EQ(*parse_realism(names_of(Realism::all())), Realism::all());
  const auto two = parse_realism("mosaic,bounce");
  ASSERT_TRUE(two);
  EXPECT_TRUE(two->mosaic && two->bounce && !two->mirror);
  EXPECT_FALSE(minus(Realism::all(), *two).bounce);
  EXPECT_TRUE(minus(Realism::all(), *two).mirror);
  EXPECT_NE(parse_realism("mosaic,fog").error().context.find("'fog'"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::studio
