// SPDX-License-Identifier: Apache-2.0
// Occlusion of ambient light by a box on the floor under it, compared with closed forms.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "host/render/cpu/compositor_cpu.h"
#include "host/render/tables/contact_shade.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr float kHalfM = 0.2F, kHighM = 0.5F, kBoxAlbedo = 0.5F;

/// A box whose bottom is at its origin, with z up.
struct BoxObject {
  BoxObject() {
    for (int i = 0; i < 8; ++i)
      positions_m.emplace_back(i & 1 ? kHalfM : -kHalfM, i & 2 ? kHalfM : -kHalfM,
                               i & 4 ? kHighM : 0);
    normals.assign(8, {0, 0, 1});
    for (const std::array<std::uint32_t, 4> f : std::initializer_list<std::array<std::uint32_t, 4>>{
             {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}})
      for (const std::size_t k : {0, 1, 2, 0, 2, 3}) indices.push_back(f[k]);
    object.meshes.push_back({positions_m, normals, {}, indices, glm::vec3(kBoxAlbedo), {}, true});
  }
  std::vector<glm::vec3> positions_m, normals;
  std::vector<std::uint32_t> indices;
  render::VirtualObject object;
};

/// Share of the cosine-weighted hemisphere over the floor that an upright rectangle fills, `away`
/// before it, from its bottom up, as far to both sides (Howell, configuration B-4).
double upright(double away, double left, double right, double high) {
  const auto corner = [&](double wide) {
    const double slant = std::hypot(away, high);
    return (std::atan(wide / away) - away / slant * std::atan(wide / slant)) /
           (2 * std::numbers::pi);
  };
  return corner(left) + corner(right);
}

float share_of(std::uint8_t byte) { return static_cast<float>(byte) / 255; }

TEST(ContactShade, a_box_hides_what_its_side_fills_of_the_sky) {
  const BoxObject box;
  const render::ContactShade shade = render::make_contact_shade(box.object);
  constexpr int kLast = render::kContactOutside + render::kContactInside;
  const auto at = [&](int x, int y, int z) {
    return shade.hidden.at(
        static_cast<std::size_t>((z * render::kContactNodes + y) * render::kContactNodes + x));
  };
  EXPECT_FLOAT_EQ(shade.reach_m, kHighM);
  EXPECT_NEAR(shade.albedo.g, kBoxAlbedo, 1e-6F);
  for (int step = 1; step < render::kContactOutside; ++step)
    for (const int y : {8, 15, 20}) {
      const double away = shade.reach_m * std::pow(step / double{render::kContactOutside}, 2);
      const double across =
          double{2 * kHalfM} * (y - render::kContactOutside) / render::kContactInside;
      const double expected = upright(away, across, 2 * kHalfM - across, kHighM);
      EXPECT_NEAR(share_of(at(kLast + step, y, render::kContactOutside).up[2]), expected, 0.035)
          << away << " m before it, y " << y;
    }
  // Along the side itself half of the sky is the box, which a surface that faces away does not see,
  // but for the floor that the box makes darker.
  EXPECT_NEAR(share_of(at(kLast, 15, render::kContactOutside).up[2]), 0.5, 0.06);
  EXPECT_LT(share_of(at(kLast, 15, kLast).up[0]), 0.12F);
  EXPECT_GT(share_of(at(kLast, 15, render::kContactOutside + 1).up[0]), 0.15F);
  EXPECT_GT(share_of(at(kLast, 15, 15).down[0]), 0.9F);
  EXPECT_EQ(at(0, 15, 15).up[0], 0) << "at the border of the grid";
  EXPECT_LT(share_of(at(15, 15, 15).up[2]), 0.9F) << "within the box is as on its surface";
}

TEST(ContactShade, is_of_objects_that_cast_shadows_alone) {
  BoxObject box;
  render::CompositorSetup setup;
  EXPECT_FALSE(has_contact(setup, box.object));
  setup.light.contact = true;
  EXPECT_TRUE(has_contact(setup, box.object));
  box.object.in_set = true;
  EXPECT_FALSE(has_contact(setup, box.object));
  box.object.in_set = false, box.object.casts_shadow = false;
  EXPECT_FALSE(has_contact(setup, box.object));
}

// The camera looks straight down at the floor, 3 m away, on which the box stands; there is no lamp.
// The light that the box hides comes back by half of its albedo.
TEST(ContactShade, the_floor_becomes_darker_beside_a_box) {
  constexpr Size kView{160, 128};
  constexpr float kBelowM = 3;
  const Image<float> depth_m(kView, kBelowM);
  const Image<Rgbf> color(kView, {0.4F, 0.4F, 0.4F});
  BoxObject box;
  render::CompositorSetup setup = plain_setup(kView, 100, {40, 32}, 25);
  setup.background.depth_m = depth_m, setup.background.color = color;
  setup.light.ambient = Eigen::Vector3f::Constant(0.3F), setup.light.contact = true;
  box.object.world_from_object.translation_m = {0, 0, kBelowM};
  box.object.world_from_object.rotation =
      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  setup.objects.push_back(box.object);
  const auto made = render::make_cpu_compositor(setup, 1);
  ASSERT_TRUE(made);
  const Image<Rgb8> plate(kView, {170, 170, 170});
  const Image<float> tof({40, 32}, 0);
  render::FrameOutput out;
  out.wanted = render::kAll;
  ASSERT_TRUE((*made)->compose({plate, tof, {}}, out));
  int judged = 0;
  for (int x = 0; x < kView.width; ++x) {
    if (out.layer.at(x, 64) == static_cast<std::uint8_t>(render::Layer::kVirtual)) continue;
    const double across = (x - setup.view.cx_px) / 100 * kBelowM;
    const double away = std::abs(across) - double{kHalfM};
    if (away < 0.01 || away > 0.36) continue;  // below the box; towards the grid's border it fades
    const double hidden = upright(away, kHalfM, kHalfM, kHighM);
    EXPECT_NEAR(out.light.at(x, 64), 1 - hidden * (1 - 0.5 * double{kBoxAlbedo}), 0.025) << away;
    ++judged;
  }
  EXPECT_GT(judged, 20);
  EXPECT_LT(out.light.at(90, 64), 0.87F);
}

}  // namespace
}  // namespace mixrig::test
