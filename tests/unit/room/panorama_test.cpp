// SPDX-License-Identifier: Apache-2.0
// Panoramas of a box whose views have a formula.
#include "host/room/scan/panorama/panorama.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/box_views.h"

namespace mixrig::model {
namespace {

constexpr int kHeight = 180;
using test::box_camera;
using test::box_view;
using test::box_views;
using test::to_wall_m;

Panorama fuse(const std::vector<ScanView>& views, bool smooth = false) {
  Crew crew(2);
  return make_panorama(views, box_camera(), box_camera(), {kHeight, smooth, false}, crew);
}

/// Whether all rays within about six degrees hit the same wall.
bool is_off_the_edges(const Eigen::Vector3d& ray) {
  std::array<double, 3> walls_m{};
  for (int k = 0; k < 3; ++k)
    walls_m[static_cast<std::size_t>(k)] = test::kBoxHalf_m[k] / std::abs(ray[k]);
  std::sort(walls_m.begin(), walls_m.end());
  return walls_m[1] > 1.25 * walls_m[0];
}

/// Root mean square of distance minus truth over measured pixels away from the box's edges.
double rms_m(const Panorama& p) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < 2 * kHeight; ++x) {
      if (p.views.at(x, y) == 0 || !is_off_the_edges(direction_of(p.size(), x, y))) continue;
      const double off = p.distance_m.at(x, y) - to_wall_m({0, 0, 0}, direction_of(p.size(), x, y));
      sum += off * off, ++count;
    }
  return std::sqrt(sum / count);
}

TEST(Panorama, HoldsTheBoxInAllDirectionsWithItsPoles) {
  const Panorama p = fuse(box_views());
  EXPECT_DOUBLE_EQ(p.measured_share, 1);
  EXPECT_LT(rms_m(p), 0.001);
  EXPECT_LT(rms_m(fuse(box_views(), true)), 0.001);
  for (const int y : {0, kHeight - 1})
    for (int x = 0; x < 2 * kHeight; x += 45) {
      const double truth_m = to_wall_m({0, 0, 0}, direction_of(p.size(), x, y));
      EXPECT_NEAR(p.distance_m.at(x, y), truth_m, 0.002);
      EXPECT_EQ(p.field.at(x, y), 1);
      EXPECT_EQ(p.color.at(x, y), (Rgb8{200, 100, 50}));
    }
}

TEST(Panorama, OverlapsLowerTheNoiseAndSmoothingMore) {
  const std::vector<ScanView> views = box_views({.noise_m = 0.012});
  const double plain_m = rms_m(fuse(views)), smooth_m = rms_m(fuse(views, true));
  EXPECT_LT(plain_m, 0.012);
  EXPECT_LT(smooth_m, 0.6 * plain_m);
}

TEST(Panorama, ASpikeOnASlopeBecomesTheSlope) {
  // The floor below: its distance changes by a tenth of a metre over a few pixels.
  std::vector<ScanView> views{box_view(0, -0.9, {.noise_m = 0.002})};
  views[0].distance_m.at(48, 40) += 0.08F;
  const Panorama plain = fuse(views), smooth = fuse(views, true);
  const auto most_off_m = [](const Panorama& p) {
    double most = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < 2 * kHeight; ++x) {
        const Eigen::Vector3d ray = direction_of(p.size(), x, y);
        if (p.views.at(x, y) == 0 || ray.z() > -0.7 || !is_off_the_edges(ray)) continue;
        most = std::max(most, std::abs(p.distance_m.at(x, y) - to_wall_m({0, 0, 0}, ray)));
      }
    return most;
  };
  EXPECT_GT(most_off_m(plain), 0.025);
  EXPECT_LT(most_off_m(smooth), 0.4 * most_off_m(plain));
}

TEST(Panorama, WhoMovedBetweenOverlappingViewsLeavesNoTrace) {
  // Two views of almost the same field; one is filled by somebody at 1 m.
  const std::vector<ScanView> views{box_view(0, 0, {.noise_m = 0.005}),
                                    box_view(0.05, 0, {.noise_m = 0.005, .sheet_m = 1.0}),
                                    box_view(0.1, 0.05, {.noise_m = 0.005})};
  const std::vector<ScanView> tie{box_view(0, 0, {.noise_m = 0.005, .sheet_m = 1.0}),
                                  box_view(0.05, 0, {.noise_m = 0.005})};
  for (const auto* seen : {&views, &tie}) {
    const Panorama p = fuse(*seen);
    for (int y = kHeight / 2 - 15; y < kHeight / 2 + 15; ++y)
      for (int x = kHeight - 20; x < kHeight + 20; ++x)
        EXPECT_NEAR(p.distance_m.at(x, y), to_wall_m({0, 0, 0}, direction_of(p.size(), x, y)),
                    0.06);
  }
}

TEST(Panorama, WhatNoViewSeesStaysUnknown) {
  const Panorama p = fuse({box_view(0, 0)});
  EXPECT_EQ(p.distance_m.at(0, kHeight / 2), 0);  // behind
  EXPECT_EQ(p.field.at(0, kHeight / 2), 0);
  EXPECT_GT(p.distance_m.at(kHeight, kHeight / 2), 0);
  EXPECT_EQ(p.views.at(kHeight, kHeight / 2), 1);
}

TEST(Panorama, SmallHolesAreFilledAndSaidToBe) {
  ScanView view = box_view(0, 0);
  // The ray straight ahead is at pixel (45.7, 40.9): the camera is beside the origin.
  for (int y = 37; y < 45; ++y)
    for (int x = 42; x < 50; ++x) view.distance_m.at(x, y) = 0;
  const Panorama p = fuse({view});
  const int x = kHeight, y = kHeight / 2;
  EXPECT_EQ(p.views.at(x, y), 0);
  EXPECT_NEAR(p.distance_m.at(x, y), 2.0, 0.02);
  EXPECT_GT(p.sigma_m.at(x, y), 0.002F);
  EXPECT_LT(p.measured_share, p.known_share);
}

TEST(Panorama, AHoleInAWallSeenAtAnAngleIsFilledAlongTheWall) {
  // The wall ahead, where it is seen at 28 degrees from its normal: 21 mm a pixel.
  ScanView view = box_view(0.7, 0);
  for (int y = 34; y < 46; ++y)
    for (int x = 56; x < 68; ++x) view.distance_m.at(x, y) = 0;
  const Panorama p = fuse({view});
  int filled = 0;
  for (int y = kHeight / 2 - 15; y < kHeight / 2 + 15; ++y)
    for (int x = 0; x < 2 * kHeight; ++x) {
      const Eigen::Vector3d ray = direction_of(p.size(), x, y);
      if (p.views.at(x, y) > 0 || p.distance_m.at(x, y) <= 0 || !is_off_the_edges(ray)) continue;
      EXPECT_NEAR(p.distance_m.at(x, y), to_wall_m({0, 0, 0}, ray), 0.006) << x << " " << y;
      ++filled;
    }
  EXPECT_GT(filled, 30);
}

TEST(Panorama, FieldEndsWhereTheViewEnds) {
  const Panorama p = fuse({box_view(0, 0)});
  int field = 0, filled = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < 2 * kHeight; ++x) {
      field += p.field.at(x, y);
      filled += p.field.at(x, y) && p.views.at(x, y) == 0;
      EXPECT_EQ(p.field.at(x, y) > 0, p.distance_m.at(x, y) > 0);
    }
  EXPECT_GT(field, 3000);
  EXPECT_LT(filled, field / 50) << "at most a pixel around what was measured";
}

TEST(Panorama, ColourOfWhoStoodBeforeTheRoomIsNotTheRooms) {
  std::vector<ScanView> views{box_view(0, 0, {.noise_m = 0.005}),
                              box_view(0.05, 0, {.noise_m = 0.005, .sheet_m = 1.0}),
                              box_view(0.1, 0.05, {.noise_m = 0.005})};
  views[1].plate.fill({10, 220, 10});
  const Panorama p = fuse(views);
  for (int y = kHeight / 2 - 15; y < kHeight / 2 + 15; ++y)
    for (int x = kHeight - 20; x < kHeight + 20; ++x)
      EXPECT_EQ(p.color.at(x, y), (Rgb8{200, 100, 50})) << x << " " << y;
}

TEST(Panorama, ColourIsAsFineAsTheTargetCamera) {
  // Its focal length is 3.1 times that of the panorama: 57.3 px a radian.
  const geometry::CameraModel target{{{240, 200}, 180, 180, 119.5, 99.5}, {}};
  ScanView view = box_view(0, 0);
  // Stripes of the wall ahead, 60 mm wide: 1.7 pixels of its distances.
  view.plate.reset(target.size_px());
  const auto stripe = [](double x_m) { return std::fmod(x_m + 6, 0.12) < 0.06; };
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 240; ++x) {
      const Eigen::Vector3d ray =
          view.base_from_target.rotation * Eigen::Vector3d((x - 119.5) / 180, (y - 99.5) / 180, 1);
      const double x_m = view.base_from_target.translation_m.x() +
                         ray.x() / ray.y() * (2.0 - view.base_from_target.translation_m.y());
      view.plate.at(x, y) = stripe(x_m) ? Rgb8{230, 230, 230} : Rgb8{40, 40, 40};
    }
  Crew crew(2);
  const Panorama p = make_panorama(std::vector<ScanView>{view}, box_camera(), target,
                                   {kHeight, false, false}, crew);
  ASSERT_EQ(p.color.size(), (Size{2 * 3 * kHeight, 3 * kHeight}));
  int right = 0, all = 0;
  for (int y = p.color.height() / 2 - 30; y < p.color.height() / 2 + 30; ++y)
    for (int x = p.color.width() / 2 - 60; x < p.color.width() / 2 + 60; ++x) {
      const Eigen::Vector3d ray = direction_of(p.color.size(), x, y);
      const bool bright = stripe(2.0 * ray.x() / ray.y());
      right += bright == (p.color.at(x, y).r > 128), ++all;
    }
  EXPECT_GT(right, 0.93 * all);
}

TEST(ViewAverage, WeighsFramesByTheSquareOfTheirAmplitude) {
  ViewAverage average(box_camera(), {0.01, 0, 0}, true);
  Image<float> first({96, 80}, 2.0F), second({96, 80}, 2.1F), strong({96, 80}, 2.0F),
      weak({96, 80}, 1.0F);
  first.at(3, 4) = 0;
  second.at(5, 6) = std::nanf("");
  average.add(first.view(), strong.view());
  average.add(second.view(), weak.view());
  Image<float> distance_m, sigma_m;
  average.finish(distance_m, sigma_m);
  EXPECT_NEAR(distance_m.at(0, 0), (4 * 2.0 + 2.1) / 5, 1e-5);
  EXPECT_NEAR(sigma_m.at(0, 0), 0.01 / std::sqrt(2), 1e-6);
  EXPECT_NEAR(distance_m.at(3, 4), 2.1, 1e-5);
  EXPECT_NEAR(distance_m.at(5, 6), 2.0, 1e-5);
  average.clear();
  average.finish(distance_m, sigma_m);
  EXPECT_EQ(distance_m.at(0, 0), 0);
}

/// The camera's noise model states 1 mm, for a bright surface; a dark one scatters by 40 mm.
TEST(ViewAverage, WhereLittleLightReturnsSigmaIsThatOfTheScatter) {
  ViewAverage average(box_camera(), {0.001, 0, 0}, true);
  std::mt19937 random(4);
  std::normal_distribution<float> noise;
  constexpr float kBright = 400, kDark = 10;
  Image<float> depth_m({96, 80}), amplitude({96, 80});
  for (int frame = 0; frame < 4; ++frame) {
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 96; ++x) {
        amplitude.at(x, y) = y < 50 ? kBright : kDark;
        depth_m.at(x, y) = 2 + 0.4F / amplitude.at(x, y) * noise(random);
      }
    average.add(depth_m.view(), amplitude.view());
  }
  Image<float> distance_m, sigma_m;
  average.finish(distance_m, sigma_m);
  EXPECT_NEAR(sigma_m.at(40, 20), 0.0005, 0.00005);
  EXPECT_NEAR(sigma_m.at(40, 70), 0.02, 0.002);
}

TEST(ViewAverage, OfSurfacesKeepsTheOneThatMostFramesSeeOrTheFartherOne) {
  const auto averaged_m = [](const std::vector<float>& depths_m) {
    ViewAverage average(box_camera(), {0.01, 0, 0}, true);
    for (const float depth_m : depths_m)
      average.add(Image<float>({96, 80}, depth_m).view(), Image<float>({96, 80}, 1.0F).view());
    Image<float> distance_m, sigma_m;
    average.finish(distance_m, sigma_m);
    return distance_m.at(40, 40);
  };
  EXPECT_NEAR(averaged_m({3.01F, 2, 2.99F, 3}), 3, 1e-5);
  EXPECT_NEAR(averaged_m({2, 3.01F, 2.99F, 3}), 3, 1e-5);
  EXPECT_NEAR(averaged_m({2, 3, 2, 3}), 3, 1e-5);
  EXPECT_NEAR(averaged_m({3, 3, 2, 2}), 3, 1e-5);
  EXPECT_NEAR(averaged_m({2, 3}), 2.5, 1e-5) << "none was seen twice";
  EXPECT_NEAR(averaged_m({2, 2.02F, 3}), 2.01, 1e-5);
  EXPECT_NEAR(averaged_m({1, 2, 3, 3}), 3, 1e-5);
  EXPECT_NEAR(averaged_m({4, 1, 3, 3}), 3, 1e-5);
  EXPECT_NEAR(averaged_m({1, 2, 4, 6, 3, 3}), 3.25, 1e-5) << "a fifth surface is left out";
}

}  // namespace
}  // namespace mixrig::model
