// SPDX-License-Identifier: Apache-2.0
// The learned room as light falls on it, against the planes that it was made of.
#include "host/render/tables/light_surface.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::test {
namespace {

using render::PackedNormal;

constexpr Size kNoisyView{320, 240};
const geometry::Pinhole kNoisyEye{kNoisyView, 260, 260, 159.5, 119.5};
const render::NoiseParams kStepNoise{0, 0, 0.0025F};  // of structured light: 40 mm at 4 m
constexpr double kFloorDown_m = 0.9, kBackWall_m = 4.5;
/// A box on the floor before the wall, and a hole in what is known of the floor and of the box.
constexpr render::Rect kBox{200, 155, 270, 197}, kFloorHole{60, 205, 100, 225},
    kBoxHole{225, 165, 245, 180};
constexpr double kBox_m = 3;

bool holds(const render::Rect& rect, int u, int v, int margin = 0) {
  return u >= rect.x0 - margin && u < rect.x1 + margin && v >= rect.y0 - margin &&
         v < rect.y1 + margin;
}
double floor_m(int v) { return kFloorDown_m * kNoisyEye.fy_px / (v - kNoisyEye.cy_px); }
bool shows_floor(int v) { return v > kNoisyEye.cy_px && floor_m(v) < kBackWall_m; }
double noisy_truth_m(int u, int v) {
  if (holds(kBox, u, v)) return kBox_m;
  return shows_floor(v) ? floor_m(v) : kBackWall_m;
}

/// Depths as a camera of steps has them: patches of 5x5 pixels are off together.
Image<float> noisy_room() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Image<double> off({kNoisyView.width / 5 + 1, kNoisyView.height / 5 + 1});
  for (int v = 0; v < off.height(); ++v)
    for (int u = 0; u < off.width(); ++u) off.row(v)[u] = 0.7 * normal(random);
  Image<float> depth_m(kNoisyView);
  for (int v = 0; v < kNoisyView.height; ++v)
    for (int u = 0; u < kNoisyView.width; ++u) {
      const double z = noisy_truth_m(u, v);
      if (holds(kFloorHole, u, v) || holds(kBoxHole, u, v)) continue;
      depth_m.row(v)[u] =
          static_cast<float>(z + 0.0025 * z * z * (off.row(v / 5)[u / 5] + 0.3 * normal(random)));
    }
  return depth_m;
}

double angle_deg(const PackedNormal& n, const Eigen::Vector3d& truth) {
  const Eigen::Vector3d v(n.x, n.y, n.z);
  return std::acos(std::min(1.0, v.normalized().dot(truth))) * 180 / M_PI;
}
const Eigen::Vector3d kFloorUp(0, -1, 0), kWallTowards(0, 0, -1);

TEST(LightSurface, a_noisy_floor_and_wall_are_planes) {
  const Image<float> depth_m = noisy_room();
  const auto surface = render::light_surface(depth_m, kNoisyEye, kStepNoise, 1);
  const auto plain = render::normals(depth_m, kNoisyEye, 2);
  double worst_deg = 0, worst_m = 0, worst_plain_deg = 0;
  int judged = 0;
  for (int v = 10; v < kNoisyView.height; ++v)
    for (int u = 0; u < kNoisyView.width; ++u) {
      // Within 0.3 m of their common edge they are one surface to this camera.
      const double z = noisy_truth_m(u, v);
      const bool near_edge = shows_floor(v) ? z > kBackWall_m - 0.3 : v > 119 + 40;
      if (holds(kBox, u, v, 8) || near_edge) continue;
      const Eigen::Vector3d truth = shows_floor(v) ? kFloorUp : kWallTowards;
      worst_deg = std::max(worst_deg, angle_deg(surface.normal.row(v)[u], truth));
      worst_m = std::max(worst_m, std::abs(surface.depth_m.row(v)[u] - z));
      if (!holds(kFloorHole, u, v, 8))
        worst_plain_deg = std::max(worst_plain_deg, angle_deg(plain.row(v)[u], truth));
      ++judged;
    }
  EXPECT_GT(judged, 50000);
  EXPECT_LT(worst_deg, 1.5);  // packed normals have 0.5
  EXPECT_LT(worst_m, 0.02);
  EXPECT_GT(worst_plain_deg, 20);  // without: the test can fail
}

TEST(LightSurface, what_stands_on_the_floor_is_kept_and_a_hole_belongs_to_what_is_around_it) {
  const Image<float> depth_m = noisy_room();
  const auto surface = render::light_surface(depth_m, kNoisyEye, kStepNoise, 1);
  int wrong = 0;
  for (int v = kBox.y0 + 2; v < kBox.y1 - 8; ++v)
    for (int u = kBox.x0 + 2; u < kBox.x1 - 2; ++u)
      wrong += std::abs(surface.depth_m.row(v)[u] - kBox_m) < 0.1 ? 0 : 1;
  EXPECT_EQ(wrong, 0);
  EXPECT_NEAR(surface.depth_m.at(80, 215), floor_m(215), 0.02);
  EXPECT_NEAR(surface.depth_m.at(235, 172), kBox_m, 0.05);
}

TEST(LightSurface, a_curved_surface_stays_and_its_normals_follow_the_noise_no_more) {
  // A column of 0.6 m radius, 3 m away: no region of it is a plane that holds to its edges.
  Image<float> depth_m(kNoisyView), true_m(kNoisyView);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const double middle_m = 3.6, radius_m = 0.6;
  for (int v = 0; v < kNoisyView.height; ++v)
    for (int u = 0; u < kNoisyView.width; ++u) {
      const double x = (u - kNoisyEye.cx_px) / kNoisyEye.fx_px, a = 1 + x * x;
      const double root = middle_m * middle_m - a * (middle_m * middle_m - radius_m * radius_m);
      if (root < 0) continue;
      const double z = (middle_m - std::sqrt(root)) / a;
      true_m.row(v)[u] = static_cast<float>(z);
      depth_m.row(v)[u] = static_cast<float>(z + 0.002 * normal(random));
    }
  const auto surface = render::light_surface(depth_m, kNoisyEye, {0.002F, 0, 0}, 1);
  for (int v = 40; v < 200; v += 5)
    for (int u = 125; u < 195; u += 3) {
      const double z = true_m.row(v)[u], x = (u - kNoisyEye.cx_px) / kNoisyEye.fx_px * z;
      EXPECT_NEAR(surface.depth_m.row(v)[u], z, 0.01) << u << "," << v;
      EXPECT_LT(angle_deg(surface.normal.row(v)[u], Eigen::Vector3d(x, 0, z - middle_m) / radius_m),
                15)
          << u << "," << v;
    }
}

/// A floor that is measured 3 % too far, as by light that comes on more than one way.
TEST(LightSurface, the_floor_goes_through_the_foot_of_what_stands_on_it) {
  Image<float> far_m = noisy_room();
  for (int v = 0; v < kNoisyView.height; ++v)
    for (int u = 0; u < kNoisyView.width; ++u) far_m.row(v)[u] *= 1.03F;
  const auto floor_at = [&](const render::ObjectFoot& foot) {
    return render::light_surface(far_m, kNoisyEye, kStepNoise, 1, std::span(&foot, 1))
        .depth_m.at(80, 200);
  };
  EXPECT_NEAR(floor_at({{0.3, kFloorDown_m, 3}, kFloorUp}), floor_m(200), 0.02);
  const double measured_m = 1.03 * floor_m(200);
  EXPECT_NEAR(floor_at({{0.3, 0.8, 3}, kFloorUp}), measured_m, 0.03) << "it hovers";
  EXPECT_NEAR(floor_at({{0.3, kFloorDown_m, 3}, kWallTowards}), measured_m, 0.03) << "it lies";
}

/// Multipath bends a floor; the bend beside an object that stands on the floor belongs to the
/// floor, too.
TEST(LightSurface, a_bend_in_the_floor_under_an_object_belongs_to_it) {
  const render::Rect bend{60, 185, 110, 215};
  Image<float> bent_m(kNoisyView);
  for (int v = 0; v < kNoisyView.height; ++v)
    for (int u = 0; u < kNoisyView.width; ++u)
      bent_m.row(v)[u] = static_cast<float>(noisy_truth_m(u, v) * (holds(bend, u, v) ? 1.01 : 1));
  const render::NoiseParams noise{0.001F, 0, 0};
  const render::ObjectFoot foot{{0.3, kFloorDown_m, 3}, kFloorUp};
  const auto with = render::light_surface(bent_m, kNoisyEye, noise, 1, std::span(&foot, 1));
  const auto without = render::light_surface(bent_m, kNoisyEye, noise, 1);
  const double over_foot = (kFloorDown_m - 0.005) / kFloorDown_m;
  EXPECT_NEAR(with.depth_m.at(80, 200), over_foot * floor_m(200), 0.004);
  EXPECT_NEAR(without.depth_m.at(80, 200), 1.01 * floor_m(200), 0.004);
}

/// A floor that is bent so much that it is found as two planes.
TEST(LightSurface, both_parts_of_a_bent_floor_go_through_the_foot) {
  Image<float> bent_m(kNoisyView);
  for (int v = 0; v < kNoisyView.height; ++v)
    for (int u = 0; u < kNoisyView.width; ++u)
      bent_m.row(v)[u] =
          static_cast<float>(noisy_truth_m(u, v) * (u < kNoisyView.width / 2 ? 1.031 : 1.04));
  const render::ObjectFoot foot{{0.3, kFloorDown_m, 3}, kFloorUp};
  const auto surface =
      render::light_surface(bent_m, kNoisyEye, {0.001F, 0, 0}, 1, std::span(&foot, 1));
  const double over_foot = (kFloorDown_m - 0.005) / kFloorDown_m;
  for (const int u : {40, 120, 180, 280})
    EXPECT_NEAR(surface.depth_m.at(u, 225), over_foot * floor_m(225), 0.004) << u;
}

TEST(LightSurface, feet_are_below_the_middle_of_objects) {
  const std::vector<glm::vec3> positions{{-1, -1, 0.5F}, {3, -1, 0.5F}, {1, 1, 2}};
  const std::vector<std::uint32_t> triangle{0, 1, 2};
  render::VirtualObject object;
  object.meshes.push_back({positions, positions, {}, triangle, glm::vec3(1), {}, true});
  object.scale = 2, object.world_from_object.translation_m = {0, 0, 1};
  geometry::Pose camera_from_world;
  camera_from_world.translation_m = {0, 5, 0};
  const std::vector<render::ObjectFoot> feet =
      render::feet_of(std::span(&object, 1), camera_from_world);
  ASSERT_EQ(feet.size(), 1U);
  EXPECT_LT((feet[0].at_m - Eigen::Vector3d(2, 5, 2)).norm(), 1e-6);
  object.in_set = true;
  EXPECT_TRUE(render::feet_of(std::span(&object, 1), camera_from_world).empty());
}

TEST(LightSurface, nothing_known_gives_nothing) {
  const auto surface =
      render::light_surface(Image<float>({64, 48}), {{64, 48}, 50, 50, 31.5, 23.5}, kStepNoise, 1);
  for (int v = 0; v < 48; ++v)
    for (int u = 0; u < 64; ++u) EXPECT_EQ(surface.depth_m.row(v)[u], 0);
}

}  // namespace
}  // namespace mixrig::test
