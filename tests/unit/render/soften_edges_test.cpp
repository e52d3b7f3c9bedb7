// SPDX-License-Identifier: Apache-2.0
// Edges of objects against a filter by hand over their sharp coverage.
#include "host/render/cpu/virtual/soften_edges.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "hal/base/srgb.h"
#include "host/render/contract/constants.h"
#include "host/render/frame/used_look.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kSoftView{40, 32};
constexpr float kSoftTap = 0.1F;
constexpr auto kVirtualLevel = static_cast<int>(255 * render::kVirtualShare);

/// A square 2 m before the camera, turned in the picture, with another one farther back beside it.
struct Edges {
  explicit Edges(float half_m, float turn_rad, float shift_m = 0)
      : setup(plain_setup(kSoftView, 32, {4, 4}, 4)) {
    for (const float z : {2.0F, 3.0F})
      for (int corner = 0; corner < 4; ++corner) {
        const float x = corner == 0 || corner == 3 ? -half_m : half_m;
        const float y = corner < 2 ? -half_m : half_m;
        const float c = std::cos(turn_rad), s = std::sin(turn_rad);
        positions.push_back({c * x - s * y + shift_m + (z - 2) * 0.5F, s * x + c * y, z});
      }
    normals.assign(positions.size(), glm::vec3(0, 0, -1));
    for (std::size_t i = 4; i < 8; ++i) normals[i] = {0.8F, 0, -0.6F};
    render::VirtualObject object;
    render::MeshView mesh{positions, normals, {}, indices, glm::vec3(0.5F), {}, false};
    mesh.emission = glm::vec3(0.25F);
    object.meshes.push_back(mesh);
    setup.objects.push_back(object);
    render::FramePreparer preparer(setup);
    preparer.update({});
    Crew crew(2);
    render::cpu::VirtualScratch scratch(preparer.params(), kSoftView, crew.threads());
    for (render::cpu::VirtualLayer* layer : {&sharp, &soft}) {
      layer->reset(kSoftView, true, true);
      render::cpu::draw_virtual(crew, preparer.params(), scratch, *layer);
    }
    render::cpu::soften_edges(crew, kSoftTap, scratch, soft);
  }
  int sharp_at(int x, int y) const {
    return sharp.coverage.at(std::clamp(x, 0, kSoftView.width - 1),
                             std::clamp(y, 0, kSoftView.height - 1));
  }
  double filtered(int x, int y) const {
    const int beside =
        sharp_at(x - 1, y) + sharp_at(x + 1, y) + sharp_at(x, y - 1) + sharp_at(x, y + 1);
    const double wider = (1 - 4.0 * kSoftTap) * sharp_at(x, y) + double{kSoftTap} * beside;
    const double limit = 255 * double{render::kVirtualShare};
    return sharp_at(x, y) < limit ? std::min(wider, limit - 1) : std::max(wider, limit + 1);
  }
  std::vector<glm::vec3> positions, normals;
  std::vector<std::uint32_t> indices = {0, 2, 1, 0, 3, 2, 4, 6, 5, 4, 7, 6};
  render::CompositorSetup setup;
  render::cpu::VirtualLayer sharp, soft;
};

TEST(SoftenEdges, coverage_is_filtered_and_each_pixel_keeps_its_surfaces) {
  int only_by_the_filter = 0, edges = 0, of_two = 0;
  for (const float turn : {0.0F, 0.1F, 0.7F})
    for (const float shift : {0.0F, 0.9F}) {  // the second one is cut by the border of the picture
      const Edges e(0.52F, turn, shift);
      for (int y = 0; y < kSoftView.height; ++y) {
        for (int x = 0; x < kSoftView.width; ++x) {
          const int coverage = e.soft.coverage.at(x, y), before = e.sharp_at(x, y);
          ASSERT_NEAR(coverage, e.filtered(x, y), 0.51) << x << "," << y;
          ASSERT_EQ(coverage > kVirtualLevel, before > kVirtualLevel);
          if (coverage == 0) continue;
          const double share = e.filtered(x, y) / 255;
          ASSERT_GT(e.soft.w.at(x, y), 0);
          edges += coverage != before, only_by_the_filter += before == 0;
          const double nearest = e.soft.normal.at(x, y).w / 64.0;
          // An albedo of 0.5 and light of 0.25, by the share of the nearest surface.
          EXPECT_NEAR(e.soft.color.at(x, y).g / 65535.0, 0.5 * nearest, 0.006) << x << "," << y;
          EXPECT_NEAR(e.soft.emission.at(x, y).g / 65535.0, 0.25 * nearest, 0.003);
          double all = nearest;
          for (const auto& other : e.soft.others.row(y))
            if (other.x == x) {
              ++of_two, all += other.normal.w / 64.0;
              EXPECT_NEAR(other.albedo.g / 65535.0, 0.5 * other.normal.w / 64.0, 0.006);
            }
          EXPECT_NEAR(all, share, 0.02) << x << "," << y;
        }
      }
    }
  EXPECT_GT(only_by_the_filter, 200);
  EXPECT_GT(edges, 600);
  EXPECT_GT(of_two, 20);
}

/// As an edge moves over a pixel and those beside it.
TEST(SoftenEdges, an_edge_along_an_axis_has_more_than_eight_levels_near_the_truth) {
  for (const bool along_x : {true, false}) {
    std::set<int> levels;
    for (int sixteenth = -16; sixteenth <= 32; ++sixteenth) {
      const float end_px = static_cast<float>(sixteenth) / 16;  // covered of pixel 7 and beyond
      Edges e((8 + end_px + 1e-4F) / 16, 0, -0.25F);            // 4 px to the left
      const int level = along_x ? e.soft.coverage.at(7, 15) : e.soft.coverage.at(15, 7);
      const auto covered = [&](float from_px) { return std::clamp(end_px - from_px, 0.0F, 1.0F); };
      const float truth = (1 - 2 * kSoftTap) * covered(0) + kSoftTap * (covered(1) + covered(-1));
      EXPECT_NEAR(level / 255.0, truth, 0.1 + 0.002) << sixteenth;
      levels.insert(level);
    }
    EXPECT_GE(levels.size(), 9U);
  }
}

/// Blocks of one shade each with an upright step of a Gaussian lens.
Image<Rgb8> plate_of_steps(float sigma_px) {
  Image<Rgb8> plate({480, 480});
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 480; ++x) {
      const float at = 11 + 0.05F * static_cast<float>(y / 24);
      float light = 0.1F;
      for (int k = 0; k < 8; ++k) {  // over the area of the pixel
        const float d = static_cast<float>(x % 24) - at + (static_cast<float>(k) - 3.5F) / 8;
        light += 0.4F / 8 * 0.5F * std::erfc(-d / (sigma_px * std::sqrt(2.0F)));
      }
      plate.row(y)[x] = {srgb_byte_from_linear(light), srgb_byte_from_linear(light),
                         srgb_byte_from_linear(light)};
    }
  return plate;
}

/// An edge of variance s^2 has weights of s^2 / 2 on both sides, of which samples lack 1/96 px^2.
TEST(SoftenEdges, the_weight_is_that_of_the_plate) {
  Edges e(0.5F, 0);
  e.setup.target = ideal_camera({480, 480}, 400);
  e.setup.view = e.setup.target.pinhole;
  for (const float sigma : {0.3F, 0.4F, 0.5F}) {
    render::UsedLook used(e.setup);
    const Image<Rgb8> plate = plate_of_steps(sigma);
    render::FrameInput frame;
    frame.plate = plate;
    EXPECT_EQ(used.take(frame), nullptr) << "the scene asks for no look";
    EXPECT_NEAR(used.edge_tap(), 0.5F * (sigma * sigma + 1.0F / 96), 0.02F) << sigma;
  }
  e.setup.look.blur = true;
  render::UsedLook all(e.setup);
  const Image<Rgb8> plate = plate_of_steps(0.5F);
  render::FrameInput frame;
  frame.plate = plate;
  EXPECT_NE(all.take(frame), nullptr);
  EXPECT_EQ(all.edge_tap(), 0) << "all of the object is blurred";
}

TEST(SoftenEdges, a_plate_without_steps_leaves_them_sharp) {
  Edges e(0.5F, 0);
  render::UsedLook used(e.setup);
  const Image<Rgb8> plate(kSoftView, Rgb8{90, 90, 90});
  render::FrameInput frame;
  frame.plate = plate;
  EXPECT_EQ(used.take(frame), nullptr);
  EXPECT_EQ(used.edge_tap(), 0);
}

}  // namespace
}  // namespace mixrig::test
