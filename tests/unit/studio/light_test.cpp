// SPDX-License-Identifier: Apache-2.0
// Light of the panels against brute-force integration and simple geometry.
#include "studio/stage/light.h"

#include <gtest/gtest.h>

#include "studio/stage/room.h"

namespace mixrig::studio {
namespace {

Light one_lamp() {
  Light light;
  light.lamps.push_back({"lamp", {0, 0, 3}, {0, 0, -1}, {0.6, 0.6}, {2, 2, 2}});
  return light;
}

double integrate(const Vec3& p, const Vec3& n) {
  constexpr int kSteps = 300;
  double sum = 0;
  for (int j = 0; j < kSteps; ++j)
    for (int i = 0; i < kSteps; ++i) {
      const double x = -0.3 + 0.6 * (i + 0.5) / kSteps - p.x(),
                   y = -0.3 + 0.6 * (j + 0.5) / kSteps - p.y(), z = 3.0 - p.z();
      const double d2 = x * x + y * y + z * z;
      const double receiver = std::max(0.0, x * n.x() + y * n.y() + z * n.z());
      sum += receiver * z / (d2 * d2);
    }
  return sum / (kSteps * kSteps);
}

TEST(Light, irradiance_is_the_mean_over_the_panel) {
  const LampSet lamps(one_lamp());
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1.2F, 0.4F, 0.5F), Vec3(-2, 1, 1.5F)})
    for (const Vec3& n : {Vec3(0, 0, 1), Vec3(0, 0.6F, 0.8F), Vec3(1, 0, 0)}) {
      const double truth = integrate(p, n);
      EXPECT_NEAR(lamps.irradiance(p, n, lamps.facing(p, n)), truth, 0.01 * truth + 1e-5);
    }
}

TEST(Light, straight_below_a_small_lamp_it_is_one_over_d_squared) {
  Light light = one_lamp();
  light.lamps[0].size_m = {1e-4, 1e-4};
  const LampSet lamps(light);
  EXPECT_NEAR(lamps.irradiance({0, 0, 1}, {0, 0, 1}, ~0ULL), 0.25, 1e-5);
}

TEST(Light, a_surface_that_looks_down_gets_none) {
  const LampSet lamps(one_lamp());
  EXPECT_EQ(lamps.facing({0, 0, 1}, {0, 0, -1}), 0U);
}

TEST(Light, half_a_roof_hides_half_the_panel) {
  auto device = TraceDevice::create();
  ASSERT_TRUE(device);
  TraceScene roof(*device);
  Mesh mesh;
  add_quad(mesh, {0, -5, 2}, {5, 0, 0}, {0, 10, 0}, {});
  roof.set(mesh);
  const LampSet lamps(one_lamp());
  const Extent extent = extent_of(roof.mesh());
  const LampMask all = lamps.facing({0, 0, 0}, {0, 0, 1});
  EXPECT_EQ(all, 0xFFFFU);
  const LampMask open = lamps.open(roof, &extent, {0, 0, 0}, all);
  EXPECT_EQ(open, 0x3333U);  // the columns with x < 0
}

TEST(Light, skipping_by_the_box_never_changes_the_shadow) {
  auto device = TraceDevice::create();
  ASSERT_TRUE(device);
  TraceScene ball(*device);
  Mesh mesh;
  add_ellipsoid(mesh, {2.5F, 2, 1.2F}, {0.3F, 0, 0}, {0, 0.3F, 0}, {0, 0, 0.6F}, 24, {});
  ball.set(mesh);
  const Extent extent = extent_of(ball.mesh());
  Light light;
  light.lamps = ceiling_lamps(1);
  const LampSet lamps(light);
  int shaded = 0;
  for (float y = 0.05F; y < 4.3F; y += 0.21F)
    for (float x = 0.05F; x < 5.2F; x += 0.23F) {
      const Vec3 p(x, y, 0.01F), up(0, 0, 1);
      const LampMask wanted = lamps.facing(p, up);
      const LampMask open = lamps.open(ball, nullptr, p, wanted);
      EXPECT_EQ(lamps.open(ball, &extent, p, wanted), open);
      shaded += open != wanted ? 1 : 0;
    }
  EXPECT_GT(shaded, 20);
}

}  // namespace
}  // namespace mixrig::studio
