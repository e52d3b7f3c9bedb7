// SPDX-License-Identifier: Apache-2.0
// Bright regions against disks drawn by formula.
#include "host/room/lamps/bright_regions.h"

#include <random>

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "hal/base/srgb.h"
#include "host/room/lamps/lamp_plane.h"
#include "tests/unit/lamps/drawn_fisheye.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector3d;
using test::DrawnFisheye;

RayOfPixel rays_of(const DrawnFisheye& lens) {
  return [lens](const Eigen::Vector2d& px) { return lens.ray(px); };
}

Image<Rgb8> disk(const DrawnFisheye& lens, const Vector3d& at, double radius_rad, double around) {
  return lens.draw(
      [&](const Vector3d& r) { return r.dot(at) > std::cos(radius_rad) ? 255.0 : around; });
}

TEST(BrightRegions, FindADiskWithItsSolidAngleAndWhatIsAroundIt) {
  const DrawnFisheye lens;
  const Vector3d at = Vector3d(0.5, -0.7, 0.4).normalized();
  const auto regions = find_bright_regions(disk(lens, at, 0.1, 60), rays_of(lens));
  ASSERT_EQ(regions.size(), 1U);
  const BrightRegion& region = regions.front();
  EXPECT_LT(region.direction.cross(at).norm(), 0.15 / lens.f_px);
  EXPECT_NEAR(region.solid_angle_sr, 2 * kPi * (1 - std::cos(0.1)), 0.02 * kPi * 0.01);
  EXPECT_NEAR(region.surround, linear_from_srgb(60.0 / 255), 1e-3);
  EXPECT_FALSE(region.cut);
}

TEST(BrightRegions, ErrorsOfTheDirectionAreThoseOfTheCovariance) {
  const DrawnFisheye lens;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double sum = 0;
  constexpr int kDisks = 60;
  for (int i = 0; i < kDisks; ++i) {
    const Vector3d at = Vector3d(uniform(random), uniform(random), 1.2).normalized();
    const double radius = 0.03 + 0.05 * std::abs(uniform(random));
    const auto regions = find_bright_regions(disk(lens, at, radius, 90), rays_of(lens));
    ASSERT_EQ(regions.size(), 1U);
    const Vector3d u = at.unitOrthogonal(), v = at.cross(u);
    Eigen::Matrix<double, 2, 3> tangents;
    tangents << u.transpose(), v.transpose();
    const Eigen::Vector2d error = tangents * (regions.front().direction - at);
    const Eigen::Matrix2d c = tangents * regions.front().covariance * tangents.transpose();
    sum += error.dot(c.inverse() * error);
  }
  // Pixels of a drawn disk are all or nothing, by their middle: errors of neighbours are alike, so
  // the mean of e^T C^-1 e is not exactly 2.
  EXPECT_LT(sum / kDisks, 4);
  EXPECT_GT(sum / kDisks, 0.5);
}

TEST(BrightRegions, GrowIntoThe99PercentIntervalAndNoFarther) {
  DrawnFisheye lens;
  lens.size = {100, 100}, lens.f_px = 40;
  Image<Rgb8> picture(lens.size, {20, 20, 20});
  for (int y = 40; y < 50; ++y)
    for (int x = 40; x < 60; ++x) picture.at(x, y) = {255, 255, 255};
  for (int x = 40; x < 60; ++x) {
    picture.at(x, 39) = {249, 250, 255};  // within 2.576 sigmas of two grey levels below 255? no:
    picture.at(x, 50) = {251, 251, 251};  // yes
  }
  RegionOptions options;
  options.saturation = 253;
  const auto regions = find_bright_regions(picture, rays_of(lens), options);
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_EQ(regions.front().pixels, 20 * 11);
}

TEST(BrightRegions, OneChannelThatIsNotSaturatedIsNoLamp) {
  DrawnFisheye lens;
  Image<Rgb8> picture(lens.size, {255, 255, 180});
  EXPECT_TRUE(find_bright_regions(picture, rays_of(lens)).empty());
}

TEST(BrightRegions, SayThatTheImageCircleCutsThem) {
  const DrawnFisheye lens;
  const Vector3d rim(0, -std::sin(1.58), std::cos(1.58));
  const auto regions = find_bright_regions(disk(lens, rim, 0.1, 30), rays_of(lens));
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_TRUE(regions.front().cut);
}

TEST(BrightRegions, StayBoundedInAnyPicture) {
  DrawnFisheye lens;
  lens.size = {256, 256}, lens.f_px = 100;
  EXPECT_TRUE(find_bright_regions(ImageView<const Rgb8>{}, rays_of(lens)).empty());
  const Image<Rgb8> white(lens.size, {255, 255, 255});
  const auto all = find_bright_regions(white, rays_of(lens));
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(all.front().cut);
  EXPECT_LE(all.front().rays.size(), static_cast<std::size_t>(kMostRegionRays));
  Image<Rgb8> noise(lens.size);
  std::mt19937 random(3);
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x)
      if (random() % 2 == 0) noise.at(x, y) = {255, 255, 255};
  EXPECT_LE(find_bright_regions(noise, rays_of(lens)).size(), RegionOptions{}.most);
}

TEST(LampPlane, FindsTheMiddleOfAPanelThatIsSeenAtAnAngle) {
  const DrawnFisheye lens;
  const geometry::Pose camera = test::looking({0.3, 2, 1.5}, {1, 0.1, 0.1});
  const Vector3d middle(2.2, 1.4, 2.9), down = -Vector3d::UnitZ();
  const auto picture = lens.draw([&](const Vector3d& r) {
    const Vector3d ray = camera.rotation * r;
    if (ray.z() <= 0) return 40.0;
    const Vector3d p = camera.translation_m + (2.9 - camera.translation_m.z()) / ray.z() * ray;
    return std::abs(p.x() - middle.x()) < 0.3 && std::abs(p.y() - middle.y()) < 0.2 ? 255.0 : 40.0;
  });
  const auto regions = find_bright_regions(picture, rays_of(lens));
  ASSERT_EQ(regions.size(), 1U);
  const auto spot = spot_on_plane(regions.front(), camera, {0, 0, 2.9}, down);
  ASSERT_TRUE(spot);
  EXPECT_LT((spot->centre_m - middle).norm(), 3e-3);
  EXPECT_NEAR(spot->size_m.x(), 0.6, 0.02);
  EXPECT_NEAR(spot->size_m.y(), 0.4, 0.02);
  // The middle of its solid angle is 1 cm and more from its own.
  const Vector3d ray = camera.rotation * regions.front().direction;
  const Vector3d seen = camera.translation_m + (2.9 - camera.translation_m.z()) / ray.z() * ray;
  EXPECT_GT((seen - middle).norm(), 0.01);
}

}  // namespace
}  // namespace mixrig::lights
