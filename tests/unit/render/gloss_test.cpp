// SPDX-License-Identifier: Apache-2.0
// Mirror reflections are compared with sums of glTF's formulas over directions (appendix B), and
// ambient light by direction with rooms whose light is given by formula.
#include "host/render/cpu/light/gloss.h"

#include <cmath>
#include <functional>
#include <vector>

#include "hal/base/learned_color.h"
#include "host/render/tables/room_ambient.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

using render::cpu::FloatLanes;
using render::cpu::ShadingLanes;
using render::cpu::VectorLanes;

constexpr double kPi = 3.14159265358979;

VectorLanes all_lanes(const glm::vec3& v) {
  return {FloatLanes{} + v.x, FloatLanes{} + v.y, FloatLanes{} + v.z};
}

/// pi times glTF's specular lobe: of light of irradiance 1 from `to_light`, over its cosine.
double lobe(const glm::dvec3& n, const glm::dvec3& to_light, const glm::dvec3& to_eye,
            double roughness, double f0) {
  const glm::dvec3 half = glm::normalize(to_light + to_eye);
  const double a2 = std::pow(roughness, 4), nl = glm::dot(n, to_light), nv = glm::dot(n, to_eye),
               nh = glm::dot(n, half), vh = glm::dot(to_eye, half);
  if (!(nl > 0)) return 0;
  const double d = a2 / std::pow(nh * nh * (a2 - 1) + 1, 2);
  const double v =
      0.5 / (nl * std::sqrt(nv * nv * (1 - a2) + a2) + nv * std::sqrt(nl * nl * (1 - a2) + a2));
  return d * v * (f0 + (1 - f0) * std::pow(1 - vh, 5));
}

/// A point at the origin, seen from 1 m away at an angle to its normal z.
struct SeenPoint {
  SeenPoint(double angle_rad, float roughness_in)
      : roughness(roughness_in), eye(std::sin(angle_rad), 0, std::cos(angle_rad)) {
    // The camera is the origin of its own axes.
    position_m = all_lanes(glm::vec3(-eye)), normal = all_lanes({0, 0, 1});
  }
  render::cpu::GlossLanes gloss() const {
    return render::cpu::GlossLanes(position_m, normal, FloatLanes{} + roughness);
  }
  float roughness;
  glm::dvec3 eye;
  VectorLanes position_m, normal;
};

TEST(Gloss, light_from_all_sides_is_mirrored_by_the_share_of_the_lobe) {
  render::LightParams light;
  light.ambient = glm::vec3(1);
  for (const float roughness : {0.25F, 0.5F, 0.8F})
    for (const double angle : {0.1, 0.7, 1.2})
      for (const double f0 : {0.04, 1.0}) {
        const SeenPoint point(angle, roughness);
        ShadingLanes sum;
        add_ambient_gloss(light, point.gloss(), sum);
        double expected = 0;
        constexpr int kUp = 500, kAround = 500;  // by equal parts of the hemisphere
        for (int i = 0; i < kUp; ++i)
          for (int j = 0; j < kAround; ++j) {
            const double z = (i + 0.5) / kUp, turn = 2 * kPi * (j + 0.5) / kAround;
            const double r = std::sqrt(1 - z * z);
            const glm::dvec3 to(r * std::cos(turn), r * std::sin(turn), z);
            expected += lobe({0, 0, 1}, to, point.eye, roughness, f0) * z * 2 / (kUp * kAround);
          }
        const double seen = f0 * sum.straight.x[0] + sum.grazing.x[0];
        EXPECT_NEAR(seen, expected, 0.04) << roughness << " " << angle << " " << f0;
      }
}

TEST(Gloss, a_point_lamp_is_mirrored_as_the_formula_says) {
  const SeenPoint point(0.6, 0.4F);
  render::LampParams lamp;
  for (const glm::vec3 to : {glm::vec3(-1.2F, 0, 1.9F), {0.5F, 0.8F, 1}, {-2, -1, 0.4F}}) {
    lamp.position_m = to - glm::vec3(point.eye);
    ShadingLanes sum;
    add_gloss(lamp, point.position_m, point.gloss(), FloatLanes{} + 2.0F, {1, 0.5F, 0}, sum);
    const double expected =
        2 * lobe({0, 0, 1}, glm::normalize(glm::dvec3(to)), point.eye, 0.4, 0.04);
    EXPECT_NEAR(0.04 * sum.straight.x[0] + sum.grazing.x[0], expected, 1e-4 + 1e-3 * expected);
    EXPECT_NEAR(sum.straight.y[0], 0.5F * sum.straight.x[0], 1e-5F);
    EXPECT_GE(sum.lost.x[0], 2 * 0.04F);
  }
}

TEST(Gloss, a_panel_is_mirrored_as_its_points_are_together) {
  // 0.6 m, 2 m above: seen in the surface where the angles are alike, and 0.5 m beside.
  constexpr double kSide_m = 0.6, kHigh_m = 2;
  for (const double beside_m : {0.0, 0.5}) {
    const SeenPoint point(0.5, 0.35F);
    const glm::dvec3 middle(-kHigh_m * std::tan(0.5) + beside_m, 0, kHigh_m);
    double expected = 0, irradiance = 0;
    constexpr int kSteps = 40;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const glm::dvec3 to =
            middle + kSide_m * glm::dvec3((i + 0.5) / kSteps - 0.5, (j + 0.5) / kSteps - 0.5, 0);
        const double d2 = glm::dot(to, to), part = to.z * to.z / (d2 * d2) / (kSteps * kSteps);
        irradiance += part;
        expected += part * lobe({0, 0, 1}, glm::normalize(to), point.eye, 0.35, 0.04);
      }
    render::LampParams lamp;
    lamp.position_m = glm::vec3(middle - point.eye);
    lamp.radius_m = static_cast<float>(kSide_m / std::sqrt(kPi));
    ShadingLanes sum;
    add_gloss(lamp, point.position_m, point.gloss(), FloatLanes{} + static_cast<float>(irradiance),
              glm::vec3(1), sum);
    const double seen = 0.04 * sum.straight.x[0] + sum.grazing.x[0];
    EXPECT_NEAR(seen / expected, 1, 0.25) << beside_m;
  }
}

/// Six pictures of one place, 2 m to every wall, whose light is a function of the direction.
struct LitCube {
  explicit LitCube(const std::function<glm::dvec3(const glm::dvec3&)>& light) {
    constexpr int kSide = 32;
    model.camera = {{kSide, kSide}, kSide / 2.1, kSide / 2.1, 0.5 * (kSide - 1), 0.5 * (kSide - 1)};
    depth_m.reset({kSide, 6 * kSide}, 2.0F), color.reset(depth_m.size());
    const double half = kPi / 2;
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
    for (const auto& [angle, axis] :
         {std::pair{0.0, x}, {half, x}, {-half, x}, {half, y}, {-half, y}, {2 * half, x}}) {
      geometry::Pose pose;
      pose.rotation = Eigen::AngleAxisd(angle, axis);
      const int top = kSide * static_cast<int>(model.world_from_face.size());
      for (int v = 0; v < kSide; ++v)
        for (int u = 0; u < kSide; ++u) {
          const Eigen::Vector2d ray = model.camera.unproject({u, v});
          const Eigen::Vector3d d =
              pose.rotation * Eigen::Vector3d(ray.x(), ray.y(), 1).normalized();
          const glm::vec3 c(light({d.x(), d.y(), d.z()}));
          color.at(u, top + v) = learned_color({c.r, c.g, c.b}, 0);
        }
      model.world_from_face.push_back(pose);
    }
    model.depth_m = depth_m, model.color = color;
    setup = plain_setup({8, 8}, 8, {4, 4}, 4);
    setup.background_models = {model};
    setup.light.by_direction = true;
    render::VirtualObject object;
    object.meshes.push_back({positions, normals, {}, indices, glm::vec3(1), {}, true});
    setup.objects.push_back(object);
  }
  Image<float> depth_m;
  Image<Rgbx8> color;
  render::BackgroundModel model;
  std::vector<glm::vec3> positions{{-0.1F, -0.1F, 0}, {0.1F, 0.1F, 0}, {0.1F, -0.1F, 0}};
  std::vector<glm::vec3> normals{3, glm::vec3(0, 0, 1)};
  std::vector<std::uint32_t> indices{0, 1, 2};
  render::CompositorSetup setup;
};

TEST(AmbientByDirection, follows_light_that_is_given_by_formula) {
  const LitCube cube([](const glm::dvec3& d) {
    return glm::dvec3(0.4 + 0.2 * d.z, 0.4 - 0.1 * d.x + 0.2 * d.x * d.y, 0.3);
  });
  render::CompositorSetup setup = cube.setup;
  setup.light.exposure = 0.5F;
  const auto terms = make_ambient(setup, {});
  ASSERT_TRUE(terms);
  const std::vector<glm::vec3> expected{
      {0.8F, 0.8F, 0.6F}, glm::vec3(0), {0.4F, 0, 0}, {0, -0.2F, 0}, {0, 0.4F, 0}};
  for (std::size_t i = 0; i < terms->size(); ++i) {
    const glm::vec3 term = i < expected.size() ? expected[i] : glm::vec3(0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR((*terms)[i][c], term[c], 0.02F) << i << " " << c;
  }
}

TEST(AmbientByDirection, leaves_lamps_out_and_is_none_where_the_room_is_not_shown) {
  // White light of a lamp straight up, at the wall.
  const LitCube cube([](const glm::dvec3& d) { return glm::dvec3(d.z > 0.97 ? 1 : 0.3); });
  render::CompositorSetup setup = cube.setup;
  EXPECT_GT(make_ambient(setup, {}).value()[2].g, 0.02F);
  setup.light.lamps.push_back({{0, 0, 2}, -Eigen::Vector3d::UnitZ(), {1.2, 1.2}, {1, 1, 1}});
  setup.light.ambient = Eigen::Vector3f::Constant(0.3F);
  EXPECT_NEAR(make_ambient(setup, {}).value()[2].g, 0, 0.01F);
  setup.light.by_direction = false;
  EXPECT_FALSE(make_ambient(setup, {}));
  setup.light.by_direction = true, setup.backdrop.emplace();
  EXPECT_FALSE(make_ambient(setup, {}));
}

TEST(AmbientByDirection, constant_light_comes_from_what_was_not_seen) {
  LitCube cube([](const glm::dvec3&) { return glm::dvec3(0.4); });
  for (int y = 32 * 3; y < 32 * 4; ++y)  // the face towards x
    for (int x = 0; x < 32; ++x) cube.depth_m.at(x, y) = 0;
  cube.setup.light.ambient = {0.4F, 0.1F, 0.1F};
  const auto terms = make_ambient(cube.setup, {});
  ASSERT_TRUE(terms);
  EXPECT_NEAR((*terms)[0].r, 0.4F, 0.005F);
  EXPECT_NEAR((*terms)[0].g, 0.4F - 0.3F / 6, 0.03F);
  EXPECT_LT((*terms)[3].g, -0.06F);
  EXPECT_NEAR((*terms)[3].r, 0, 0.005F);
}

TEST(Gloss, diffuse_ambient_light_is_the_mean_over_the_hemisphere) {
  // Light 1 + d.z: a surface that faces up has the mean of (1 + z) weighed by z: 1 + 2/3.
  render::LightParams light;
  light.exposure = 0.5F, light.by_direction = true;
  light.ambient_terms[0] = light.ambient_terms[2] = glm::vec3(1);
  ShadingLanes up, down;
  add_ambient(light, all_lanes({0, 0, 1}), up), add_ambient(light, all_lanes({0, 0, -1}), down);
  EXPECT_NEAR(up.diffuse.x[0], 0.5F * 5 / 3, 1e-4F);
  EXPECT_NEAR(down.diffuse.x[0], 0.5F * 1 / 3, 1e-4F);
}

}  // namespace
}  // namespace mixrig::test
