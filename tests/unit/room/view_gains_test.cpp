// SPDX-License-Identifier: Apache-2.0
// Gains and vignetting of views of a box of one colour, made by formula.
#include "host/room/scan/panorama/view_gains.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "tests/support/box_views.h"

namespace mixrig::model {
namespace {

using test::box_camera;
using test::box_view;
using test::box_views;

/// Darkening and tint of a view by a camera: exposure within 12 %, red and blue within 3 %.
Eigen::Array3d tint(std::size_t view) {
  const double i = static_cast<double>(view);
  return Eigen::Array3d(1 + 0.03 * std::cos(2.3 * i), 1, 1 - 0.03 * std::cos(1.7 * i)) *
         (1 + 0.12 * std::sin(1.3 * i));
}

/// Light of a pixel over that of the middle: 0.74 in the corners.
double falloff(int x, int y) {
  const double r2 = (std::pow(x - 47.5, 2) + std::pow(y - 39.5, 2)) / (48 * 48 + 40 * 40);
  return 1 / (1 + 0.35 * r2);
}

void darken(std::size_t number, bool lens, Image<Rgb8>& plate) {
  const auto& linear = linear_of_srgb_bytes();
  const Eigen::Array3d by = tint(number);
  for (int y = 0; y < plate.height(); ++y)
    for (int x = 0; x < plate.width(); ++x) {
      Rgb8& p = plate.at(x, y);
      const double all = lens ? falloff(x, y) : 1;
      const auto of = [&](std::uint8_t byte, double gain) {
        return srgb_bytes_of_linear16()[static_cast<std::size_t>(
            65535 * std::min(1.0, static_cast<double>(linear[byte]) * gain * all) + 0.5)];
      };
      p = {of(p.r, by[0]), of(p.g, by[1]), of(p.b, by[2])};
    }
}

std::vector<ScanView> unequal_views(bool lens = true, const test::BoxView& how = {}) {
  std::vector<ScanView> views = box_views(how);
  for (std::size_t i = 0; i < views.size(); ++i) darken(i, lens, views[i].plate);
  return views;
}

Panorama fuse_gains(const std::vector<ScanView>& views, bool equalise = true) {
  Crew crew(2);
  return make_panorama(
      views, box_camera(), box_camera(),
      {.height_px = 180, .smooth = false, .straighten = false, .equalise = equalise}, crew);
}

/// Largest minus least green of the panorama, 0 to 255.
int spread(const Panorama& p) {
  int least = 255, most = 0;
  for (int y = 0; y < p.color.height(); ++y)
    for (int x = 0; x < p.color.width(); ++x) {
      if (p.color.at(x, y) == Rgb8{}) continue;  // not known
      least = std::min<int>(least, p.color.at(x, y).g);
      most = std::max<int>(most, p.color.at(x, y).g);
    }
  return most - least;
}

TEST(ViewGains, MakeViewsOfOneWallEquallyBright) {
  const auto views = unequal_views();
  const Panorama p = fuse_gains(views);
  EXPECT_GT(spread(fuse_gains(views, false)), 8);
  EXPECT_LE(spread(p), 2);
  EXPECT_GT(p.gains.before_pct, 5);
  EXPECT_LT(p.gains.after_pct, 1);
}

TEST(ViewGains, AreThoseOfTheCameraAndOfTheLens) {
  const ViewGains found = fuse_gains(unequal_views()).gains;
  ASSERT_EQ(found.gains.size(), box_views().size());
  // All gains together have no truth: they are relative to their mean.
  const double common = static_cast<double>(found.gains[0][1]) * tint(0)[1];
  for (std::size_t i = 0; i < found.gains.size(); ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(static_cast<double>(found.gains[i][c]) * tint(i)[c] / common, 1, 0.012)
          << "view " << i << ", channel " << c;
  for (const double r2 : {0.25, 0.5, 0.9})
    EXPECT_NEAR(found.vignetting.factor(r2) / (1 + 0.35 * r2), 1, 0.012) << "r^2 " << r2;
}

TEST(ViewGains, StayOneWhereViewsAgree) {
  const ViewGains found = fuse_gains(box_views()).gains;
  EXPECT_TRUE(found.gains.empty());
  EXPECT_GT(found.samples, 1000);
  EXPECT_EQ(found.vignetting.factor(1), 1);
}

TEST(ViewGains, DoNotFollowWhatMovedBeforeTheWall) {
  std::vector<ScanView> views = unequal_views(false);
  // Each third view has a dark cloth in its left half: on the wall, so depth does not show it.
  for (std::size_t i = 0; i < views.size(); i += 3)
    for (int y = 0; y < views[i].plate.height(); ++y)
      for (int x = 0; x < 30; ++x) views[i].plate.at(x, y) = {90, 40, 20};
  const ViewGains found = fuse_gains(views).gains;
  ASSERT_FALSE(found.gains.empty());
  const double common = static_cast<double>(found.gains[1][1]) * tint(1)[1];
  for (std::size_t i = 0; i < found.gains.size(); ++i)
    EXPECT_NEAR(static_cast<double>(found.gains[i][1]) * tint(i)[1] / common, 1, 0.02)
        << "view " << i;
}

TEST(ViewGains, AreNotFoundFromSaturatedDarkOrTexturedPlaces) {
  for (const Rgb8 wall : {Rgb8{255, 120, 120}, Rgb8{5, 5, 5}}) {
    std::vector<ScanView> views = box_views();
    for (ScanView& view : views)
      for (int y = 0; y < view.plate.height(); ++y)
        std::fill_n(view.plate.row(y), view.plate.width(), wall);
    EXPECT_EQ(fuse_gains(views).gains.samples, 0);
  }
  const Panorama textured = fuse_gains(unequal_views(false, {.textured = true}));
  EXPECT_LT(textured.gains.samples, fuse_gains(unequal_views(false)).gains.samples / 4);
}

TEST(ViewGains, NeedOverlaps) {
  const std::vector<ScanView> views{box_view(0, 0), box_view(M_PI, 0)};
  const ViewGains found = fuse_gains(views).gains;
  EXPECT_TRUE(found.gains.empty());
  EXPECT_EQ(found.samples, 0);
}

}  // namespace
}  // namespace mixrig::model
