// SPDX-License-Identifier: Apache-2.0
// Lamps of real rooms in order of their light: panoramas of high dynamic range, resampled into a
// fisheye and clipped at several exposures. Truth is summed over the light that was not clipped.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "hal/base/srgb.h"
#include "host/math/geometry/fisheye_model.h"
#include "host/math/image_io/image_io.h"
#include "host/room/lamps/bracket.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSide = 800;
constexpr double kFocal_px = 240;

/// Equidistant, 95 degrees to each side, its axis up.
geometry::FisheyeModel lens() {
  return geometry::FisheyeModel(
      {{kSide, kSide}, kFocal_px, kFocal_px, 399.5, 399.5, {}, 95 * kDeg});
}

struct Light {
  float r = 0, g = 0, b = 0;
};

/// The fisheye's picture in linear light, by formula, without the pipeline's lens model.
Image<Light> fisheye_of(const std::vector<image_io::Channel>& channels) {
  const auto plane = [&](const char* name) -> const Image<float>& {
    return std::find_if(channels.begin(), channels.end(),
                        [&](const auto& c) { return c.name == name; })
        ->pixels;
  };
  const Image<float>&r = plane("R"), &g = plane("G"), &b = plane("B");
  Image<Light> out({kSide, kSide});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double dx = x - 399.5, dy = y - 399.5, from_axis_rad = std::hypot(dx, dy) / kFocal_px;
      if (from_axis_rad > 95 * kDeg) continue;
      const double around = std::atan2(dy, dx) / (2 * kPi) + 0.5;
      const int u = std::min(r.width() - 1, static_cast<int>(around * r.width()));
      const int v = std::min(r.height() - 1, static_cast<int>(from_axis_rad / kPi * r.height()));
      const auto at = [&](const Image<float>& c) { return std::max(0.0F, c.at(u, v)); };
      out.at(x, y) = {at(r), at(g), at(b)};
    }
  return out;
}

float least(const Light& l) { return std::min({l.r, l.g, l.b}); }

/// The light of which a share of the pixels has more in all channels.
float brightest(const Image<Light>& light, double share) {
  std::vector<float> all;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) all.push_back(least(light.at(x, y)));
  const auto at = all.end() - 1 - static_cast<std::ptrdiff_t>(share * kSide * kSide);
  std::nth_element(all.begin(), at, all.end());
  return *at;
}

Image<Rgb8> shot_of(const Image<Light>& light, double exposure) {
  const auto byte = [&](float v) {
    return static_cast<std::uint8_t>(
        std::lround(255 * srgb_from_linear(std::min(1.0, exposure * static_cast<double>(v)))));
  };
  Image<Rgb8> shot({kSide, kSide});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Light& l = light.at(x, y);
      shot.at(x, y) = {byte(l.r), byte(l.g), byte(l.b)};
    }
  return shot;
}

/// Radiance times solid angle over the pixels around (x, y) that saturate in all channels.
double true_flux(const Image<Light>& light, double exposure, const BrightRegion& region) {
  const auto bright = [&](int x, int y) {
    return exposure * static_cast<double>(least(light.at(x, y))) > 0.95;
  };
  Image<std::uint8_t> taken({kSide, kSide});
  std::vector<std::pair<int, int>> open;
  const auto take = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= kSide || y >= kSide || taken.at(x, y) != 0 || !bright(x, y)) return;
    taken.at(x, y) = 1, open.emplace_back(x, y);
  };
  const Vector2d at = *lens().project(region.rays.front().direction);
  take(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
  double flux = 0;
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto [x, y] = open[i];
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) take(x + dx, y + dy);
    const double angle_rad = std::hypot(x - 399.5, y - 399.5) / kFocal_px;
    const double sr = std::sin(angle_rad) / (angle_rad * kFocal_px * kFocal_px);
    const Light& l = light.at(x, y);
    flux += sr * static_cast<double>(kRec709Red * l.r + kRec709Green * l.g + kRec709Blue * l.b);
  }
  return flux;
}

TEST(RealBracket, LampsOfPanoramasAreInOrderOfTheirLight) {
  const char* root = std::getenv("MIXRIG_DATA");
  if (root == nullptr)
    GTEST_SKIP() << "needs hdri-indoor: set MIXRIG_DATA to the folder that holds it";
  for (const std::string room : {"lobby", "hall", "lab"}) {
    const auto channels = image_io::read_exr(std::string(root) + "/hdri-indoor/" + room + ".exr");
    ASSERT_TRUE(channels) << channels.error().context;
    const Image<Light> light = fisheye_of(*channels);
    const double longest = 1 / static_cast<double>(brightest(light, 0.01));
    std::vector<Image<Rgb8>> pictures;
    std::vector<BracketShot> shots;
    for (const double shorter : {1.0, 8.0, 64.0, 512.0})
      pictures.push_back(shot_of(light, longest / shorter));
    for (std::size_t i = 0; i < pictures.size(); ++i)
      shots.push_back({pictures[i], longest / std::exp2(3.0 * static_cast<double>(i))});
    const BracketLight bracket = light_of_bracket(shots);
    const geometry::FisheyeModel camera = lens();
    const auto regions =
        find_bright_regions(pictures[0], [&](const Vector2d& px) { return camera.unproject(px); });
    struct Lamp {
      double found = 0, truth = 0;
    };
    std::vector<Lamp> lamps;
    for (const BrightRegion& region : regions) {
      const RegionLight seen = light_of_region(
          bracket, region, [&](const Vector3d& ray) { return camera.project(ray); });
      EXPECT_EQ(seen.saturated_share, 0);
      lamps.push_back({seen.radiance * region.solid_angle_sr, true_flux(light, longest, region)});
    }
    std::sort(lamps.begin(), lamps.end(),
              [](const Lamp& a, const Lamp& b) { return a.truth > b.truth; });
    ASSERT_GE(lamps.size(), 3U) << room;
    lamps.resize(std::min<std::size_t>(lamps.size(), 6));
    for (std::size_t i = 0; i < lamps.size(); ++i) {
      const double share = lamps[i].found / lamps[0].found, truth = lamps[i].truth / lamps[0].truth;
      std::printf("%s, lamp %zu: %.3f of the brightest, true %.3f\n", room.c_str(), i + 1, share,
                  truth);
      EXPECT_NEAR(share / truth, 1, 0.2) << room << i;
      const bool is_less = i > 0 && lamps[i].truth < 0.9 * lamps[i - 1].truth;
      EXPECT_TRUE(!is_less || lamps[i].found < lamps[i - 1].found) << room << i;
    }
  }
}

}  // namespace
}  // namespace mixrig::lights
