// SPDX-License-Identifier: Apache-2.0
// The studio's lenses against OpenCV's documented formula.
#include "studio/sensors/lens.h"

#include <cmath>

#include <gtest/gtest.h>

#include "studio/rig.h"

namespace mixrig::studio {
namespace {

constexpr Optics kStrong{{640, 480}, 500, 510, 320, 240, {-0.2, 0.1, 0.01, -0.02, 0.05}};

// x = 0.5, y = -0.25, r2 = 0.3125: 1 + k1 r2 + k2 r4 + k3 r6 = 0.94879150390625, by hand.
TEST(Lens, distorts_by_the_documented_formula) {
  const Eigen::Vector2d d = distort(kStrong, {0.5, -0.25});
  EXPECT_NEAR(d.x(), 0.455645751953125, 1e-14);
  EXPECT_NEAR(d.y(), -0.2278228759765625, 1e-14);
}

TEST(Lens, projects_with_focal_length_and_centre) {
  const Eigen::Vector2d px = project(kStrong, {1.0, -0.5, 2.0});
  EXPECT_NEAR(px.x(), 500 * 0.455645751953125 + 320, 1e-9);
  EXPECT_NEAR(px.y(), 510 * -0.2278228759765625 + 240, 1e-9);
}

TEST(Lens, undistort_inverts_distort_over_every_rigs_pictures) {
  for (const RigPreset rig : {RigPreset::kSr3000, RigPreset::kKinect2, RigPreset::kHelios2})
    for (const Optics& o : {tof_sensor(rig).optics, target_optics(rig, {1280, 1024})})
      for (int y = -1; y <= o.size_px.height; y += 37)
        for (int x = -1; x <= o.size_px.width; x += 41) {
          const Eigen::Vector2d d((x - o.cx_px) / o.fx_px, (y - o.cy_px) / o.fy_px);
          EXPECT_LT((distort(o, undistort(o, d)) - d).norm(), 1e-10) << name(rig);
        }
}

TEST(Lens, ray_grid_inverts_the_projection) {
  for (const RigPreset rig : {RigPreset::kSr3000, RigPreset::kKinect2, RigPreset::kHelios2}) {
    const Optics o = tof_sensor(rig).optics;
    const RayGrid grid(o);
    for (float v = 0.3F; v < static_cast<float>(o.size_px.height - 1); v += 31.7F)
      for (float u = 0.1F; u < static_cast<float>(o.size_px.width - 1); u += 29.3F) {
        const Eigen::Vector2d ideal = grid.at(u, v).cast<double>();
        const Eigen::Vector2d px = project(o, {ideal.x(), ideal.y(), 1});
        EXPECT_NEAR(px.x(), u, 1e-3) << name(rig);
        EXPECT_NEAR(px.y(), v, 1e-3) << name(rig);
      }
  }
}

// angle 0.5: 100 (0.5 - 0.02 0.125 + 0.001 0.03125) = 49.753125 px; angle 1.6, over 90 degrees:
// 100 (1.6 - 0.02 4.096 + 0.001 10.48576) = 152.856576 px, by hand.
TEST(Lens, fisheye_ray_is_at_the_angle_of_its_radius) {
  const FisheyeOptics lens{{401, 301}, 100, 200, 150, -0.02, 0.001, 3.3};
  Eigen::Vector3d ray;
  ASSERT_TRUE(fisheye_ray(lens, 200, 150, ray));
  EXPECT_NEAR(ray.z(), 1, 1e-12);
  ASSERT_TRUE(fisheye_ray(lens, 200, 150 + 49.753125, ray));
  EXPECT_NEAR(std::atan2(ray.y(), ray.z()), 0.5, 1e-9);
  ASSERT_TRUE(fisheye_ray(lens, 200 - 152.856576, 150, ray));
  EXPECT_NEAR(std::atan2(-ray.x(), ray.z()), 1.6, 1e-9);
  EXPECT_FALSE(fisheye_ray(lens, 0, 0, ray));
}

TEST(Lens, a_prism_moves_the_corner_as_stated_and_is_undone) {
  const Optics plain = target_optics(RigPreset::kKinect2, {640, 512});
  const Optics prism = with_lens_error(plain, 0.3);
  const Eigen::Vector3d corner(319.5 / plain.fx_px, 255.5 / plain.fy_px, 1);
  EXPECT_NEAR((project(prism, corner) - project(plain, corner)).norm(), 0.3, 0.01);
  const Eigen::Vector3d halfway(0.5 * corner.x(), 0.5 * corner.y(), 1);
  EXPECT_NEAR((project(prism, halfway) - project(plain, halfway)).norm(), 0.3 / 16, 1e-3);
  const Eigen::Vector2d ideal(-0.3, 0.2);
  EXPECT_LT((undistort(prism, distort(prism, ideal)) - ideal).norm(), 1e-10);
}

}  // namespace
}  // namespace mixrig::studio
