// SPDX-License-Identifier: Apache-2.0
// Bounced and mirrored light against integrals and the mirror images of points.
#include "studio/light/reflection.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "studio/light/object_gloss.h"
#include "studio/studio.h"

namespace mixrig::studio {
namespace {

using std::numbers::pi;

/// A floor of 2 m x 2 m in front of a wall at x = 0, below one lamp.
struct MirrorCorner {
  TraceDevice device = *TraceDevice::create();
  TraceScene room{device};
  Occluder nothing{device};
  Materials materials{1, {}, nullptr};
  Light light;
  LampSet lamps;

  MirrorCorner() : light{make_light()}, lamps(light) {
    Mesh mesh;
    add_quad(mesh, {0, -1, 0}, {2, 0, 0}, {0, 2, 0}, {Kind::kPaint});
    add_quad(mesh, {0, -1, 0}, {0, 2, 0}, {0, 0, 2}, {Kind::kPaint});
    room.set(mesh);
  }
  static Light make_light() {
    Light light;
    light.lamps.push_back({"lamp", {1, 0.2, 2.5}, {0, 0, -1}, {0.4, 0.4}, {3, 2, 1}});
    return light;
  }
  Reflector reflector() const {
    Reflector r;
    r.room = &room, r.furniture = r.object = r.person = &nothing;
    r.materials = &materials, r.lamps = &lamps;
    r.ambient = Vec3(0.1F, 0.1F, 0.2F);
    return r;
  }
};

TEST(Bounce, light_by_way_of_the_floor_is_the_integral_over_it) {
  const MirrorCorner corner;
  const Vec3 albedo = corner.materials.albedo({Kind::kPaint}, {}, {});
  for (const double z : {0.15, 0.4, 1.0}) {
    constexpr int kSteps = 400;
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const Vec3 q =
            Eigen::Vector3d(2 * (i + 0.5) / kSteps, 2 * (j + 0.5) / kSteps - 1, 0).cast<float>();
        const double r2 = (Eigen::Vector3d(0, 0, z) - q.cast<double>()).squaredNorm();
        const double form = z * q.x() / (pi * r2 * r2) * 4 / kSteps / kSteps;
        const Vec3 lit = Vec3(0.1F, 0.1F, 0.2F) +
                         corner.lamps.irradiance(q, Vec3::UnitZ(), ~LampMask{0}) * Vec3(3, 2, 1);
        expected += form * albedo.cwiseProduct(lit).cast<double>();
      }
    const Vec3 at(1e-3F, 0, static_cast<float>(z));
    const Bounce many = bounce_at(corner.reflector(), at, Vec3::UnitX(), 4096, false);
    const Bounce few = bounce_at(corner.reflector(), at, Vec3::UnitX(), 64, false);
    // With as many rays as in a take, up to one and a half rays too many or too few may meet the
    // floor.
    const Vec3 ray = albedo.cwiseProduct(Vec3(0.1F, 0.1F, 0.2F) + 0.16F * Vec3(3, 2, 1)) / 64;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(many.real[c], expected[c], 0.03 * expected[c]) << z;
      EXPECT_NEAR(few.real[c], expected[c], 1.5 * static_cast<double>(ray[c])) << z;
      EXPECT_EQ(many.real[c], many.mixed[c]) << "no object";
    }
  }
}

// Ambient light alone, below one half of a square plate: its corner is right above. By formula the
// plate hides F of what the floor gets, and sends its own albedo's share of it.
TEST(Bounce, the_object_hides_ambient_light_from_the_floor_below_it) {
  const MirrorCorner corner;
  const Vec3 albedo = corner.materials.albedo({Kind::kPaint}, {}, {});
  Occluder plate{corner.device};
  for (const float high : {0.05F, 0.2F}) {
    constexpr float kWide = 0.3F;  // to the right, and to both sides
    Mesh mesh;
    add_quad(mesh, {1, -kWide, high}, {0, 2 * kWide, 0}, {kWide, 0, 0}, {Kind::kPaint});
    plate.set(mesh);
    Reflector reflector = corner.reflector();
    reflector.object = &plate;
    const Bounce bounce = bounce_at(reflector, Vec3(1, 0, 1e-3F), Vec3::UnitZ(), 4096, false);
    const float a = kWide / high, root = std::hypot(1.0F, a);
    const float form = 2 * a / root * std::atan(a / root) / static_cast<float>(pi);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(bounce.mixed[c] - bounce.real[c], form * (albedo[c] - 1) * reflector.ambient[c],
                  0.03F * reflector.ambient[c])
          << high;
  }
}

TEST(Bounce, a_node_on_another_surface_does_not_count) {
  ScreenCache<Bounce> cache;
  Crew crew(1);
  cache.reset({64, 64}, 16, 0);
  // Left of column 32 a near surface with light 1, right of it a far one with light 5.
  cache.build(crew, [](float u, float, CacheNode<Bounce>& node) {
    node.position = Vec3(u / 10, 0, u < 32 ? 1.0F : 2.0F), node.normal = -Vec3::UnitZ();
    node.value.real = Vec3::Constant(u < 32 ? 1.0F : 5.0F);
  });
  EXPECT_NEAR(cache.at(30, 20, Vec3(3, 0, 1), -Vec3::UnitZ()).real.x(), 1, 0.05F);
  EXPECT_NEAR(cache.at(30, 20, Vec3(3, 0, 2), -Vec3::UnitZ()).real.x(), 5, 0.05F);
}

TEST(Reflection, shares_are_those_of_schlick) {
  Reflector r;
  EXPECT_EQ(reflectance(r, Kind::kFloor, 0.5F), 0) << "off";
  r.gloss = r.mirror = true;
  EXPECT_NEAR(reflectance(r, Kind::kFloor, 1), 0.04F, 1e-6F);
  EXPECT_NEAR(reflectance(r, Kind::kFloor, 0), 1, 1e-6F);
  EXPECT_NEAR(reflectance(r, Kind::kPoster, 0.5F), 0.08F + 0.92F / 32, 1e-6F);
  EXPECT_EQ(reflectance(r, Kind::kMirror, 0.3F), 0.85F);
  EXPECT_EQ(reflectance(r, Kind::kWall, 0.1F), 0);
}

StudioOptions with_mirror(RigPreset rig) {
  StudioOptions o;
  o.rig = rig;
  o.seed = 7;
  o.frames = 150;
  o.size_px = {160, 128};
  o.realism.mirror = true;
  return o;
}

constexpr double kMirrorX_m = 5.263 - 0.025;

/// Point at which a pixel's ray meets the upright plane at x_m.
Eigen::Vector3d meets(const StudioInfo& info, const geometry::Pose& world_from_target, int x, int y,
                      double x_m) {
  const Eigen::Vector3d ray =
      world_from_target.rotation * Eigen::Vector3d((x - info.view.cx_px) / info.view.fx_px,
                                                   (y - info.view.cy_px) / info.view.fy_px, 1);
  const Eigen::Vector3d eye = world_from_target.translation_m;
  return eye + (x_m - eye.x()) / ray.x() * ray;
}

// A person and its image are mirror images: the image's pixels change, and are background.
TEST(Reflection, the_mirror_shows_the_person_where_its_mirror_image_is) {
  auto studio = Studio::create(with_mirror(RigPreset::kHelios2));
  ASSERT_TRUE(studio);
  Frame empty, walking;
  Truth truth;
  studio->render(2, empty);
  int changed = 0, inside = 0;
  for (int number = 30; number <= 150 && inside < 60; number += 10) {
    studio->render(number, walking, &truth);
    const Eigen::Vector2d floor = truth.people.at(0).on_floor_m;
    for (int y = 1; y < 127; ++y)
      for (int x = 1; x < 159; ++x) {
        const auto& pose = walking.world_from_target;
        const Eigen::Vector3d at = meets(studio->info(), pose, x, y, kMirrorX_m);
        if (at.y() < 1.85 || at.y() > 2.7 || at.z() < 1.0 || at.z() > 2.0) continue;
        const Eigen::Vector3d image = meets(studio->info(), pose, x, y, 2 * kMirrorX_m - floor.x());
        if (std::abs(image.y() - floor.y()) > 0.1 || image.z() < 0.9 || image.z() > 1.4) continue;
        if (truth.matte.at(x, y) > 0) continue;
        ++inside;
        const Rgb8 a = empty.color.at(x, y), b = walking.color.at(x, y);
        changed += std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) > 30;
      }
  }
  ASSERT_GT(inside, 20);
  EXPECT_GT(changed, 0.8 * inside);
}

// Through the mirror, the wall behind the camera is as far as its mirror image.
TEST(Reflection, the_depth_camera_measures_the_way_over_the_mirror) {
  auto studio = Studio::create(with_mirror(RigPreset::kKinect2));
  ASSERT_TRUE(studio);
  Frame empty;
  studio->render(2, empty);
  const double range_m = 299792458.0 / (2 * 16e6);
  const geometry::Pose world_from_tof =
      empty.world_from_target * studio->info().tof.target_from_tof;
  const Optics& o = studio->info().tof.optics;
  int known = 0, right = 0;
  for (int y = 0; y < o.size_px.height; ++y)
    for (int x = 0; x < o.size_px.width; ++x) {
      // Near the centre, where the distortion of the lens is below a pixel.
      const double u = (x - o.cx_px) / o.fx_px, v = (y - o.cy_px) / o.fy_px;
      if (std::hypot(u, v) > 0.2) continue;
      const Eigen::Vector3d ray = (world_from_tof.rotation * Eigen::Vector3d(u, v, 1)).normalized();
      const Eigen::Vector3d eye = world_from_tof.translation_m;
      const Eigen::Vector3d at = eye + (kMirrorX_m - eye.x()) / ray.x() * ray;
      if (at.y() < 1.9 || at.y() > 2.65 || at.z() < 1.1 || at.z() > 1.9) continue;
      const double there = 2 * kMirrorX_m / ray.x() - eye.x() / ray.x();
      if (empty.tof_distance_m.at(x, y) == 0) continue;
      ++known;
      const double off =
          std::remainder(static_cast<double>(empty.tof_distance_m.at(x, y)) - there, range_m);
      right += std::abs(off) < 0.1;
    }
  ASSERT_GT(known, 200);
  EXPECT_GT(right, 0.9 * known);
}

// A white dielectric in even light stays as bright as it: what is mirrored is taken from the
// colour. A black one shows what it mirrors alone: some 4 % from before, more at a grazing angle.
TEST(Gloss, an_object_in_even_light_gains_and_loses_nothing) {
  const MirrorCorner corner;
  VirtualObject object;
  object.meshes.emplace_back().roughness = 0.35F;
  Crew crew(1);
  for (const float albedo : {0.0F, 1.0F})
    for (const double angle : {0.0, 0.6, 1.4}) {
      Mesh mesh;
      add_quad(mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, {Kind::kPaint});
      TraceScene floor(corner.device);
      floor.set(mesh);
      Optics optics;
      optics.size_px = {1, 1}, optics.fx_px = optics.fy_px = 100;
      const RayGrid grid(optics);
      geometry::Pose pose;  // looks at the origin from 2 m away
      pose.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) *
                      Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX());
      pose.translation_m = -2 * (pose.rotation * Eigen::Vector3d::UnitZ());
      SurfelMap map;
      map.build(floor, corner.materials, camera_rays(grid, pose), {0, 0, 1, 1}, crew);
      ASSERT_EQ(map.at(0, 0).size(), 1U);
      Surfel& surfel = map.at(0, 0)[0];
      surfel.albedo = Vec3::Constant(albedo), surfel.open_mixed = 0;
      Reflector reflector = corner.reflector();
      reflector.ambient = Vec3::Constant(0.5F);
      reflector.eye = pose.translation_m.cast<float>();
      gloss_object(map, reflector, corner.lamps, object, false, crew);
      const float seen = surfel.gloss_mixed.x() / 0.5F;
      if (albedo == 1)
        EXPECT_NEAR(seen, 0, 1e-5F);
      else if (angle < 1)
        EXPECT_NEAR(seen, 0.042F, 0.005F) << angle;
      else
        EXPECT_GT(seen, 0.12F);
    }
}

}  // namespace
}  // namespace mixrig::studio
