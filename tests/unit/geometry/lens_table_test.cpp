// SPDX-License-Identifier: Apache-2.0
// Lenses between calibrated settings, against formulas that the table does not know.
#include "host/math/geometry/lens_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig::geometry {
namespace {

constexpr Size kSize{1280, 1024};

/// A zoom lens of 2x: its focal length grows exponentially, its barrel distortion of 3 % at the
/// corner becomes a pincushion of 1 %, its pupil moves by 2 cm, its focus breathes.
LensState zoom_lens(double zoom, double focus) {
  const double f = 1000 * std::pow(2, zoom / 1000) * (1 + 0.03 * (focus - 0.5));
  const double corner2 = (640 * 640 + 512 * 512) / (f * f);
  const double k1 = (-0.03 + 0.04 * zoom / 1000) / corner2;
  return {{{kSize, f, 1.001 * f, 640 + 0.004 * zoom, 510 - 0.003 * zoom},
           Lens({k1, 0, 1e-4 * f / 1000, 0, 0, 0, 0, 0})},
          2e-5 * zoom};
}

std::vector<LensNode> nodes_of(int zooms, std::initializer_list<double> focuses) {
  std::vector<LensNode> nodes;
  for (int i = 0; i < zooms; ++i)
    for (const double focus : focuses) {
      const double zoom = 1000.0 * i / (zooms - 1);
      nodes.push_back({{zoom, focus}, zoom_lens(zoom, focus), 0.1});
    }
  return nodes;
}

TEST(LensTable, HoldsItsNodesAndIsCloseBetweenThem) {
  auto nodes = nodes_of(5, {0, 0.5, 1});
  std::reverse(nodes.begin(), nodes.end());
  const auto table = LensTable::make(nodes);
  ASSERT_TRUE(table) << table.error().context;
  for (const LensNode& node : nodes)
    EXPECT_LT(largest_shift_px(table->at(node.at), node.lens, 2), 1e-6);
  double most_px = 0;
  for (int i = 0; i <= 40; ++i)
    for (const double focus : {0.0, 0.2, 0.5, 0.9}) {
      const double zoom = 25.0 * i;
      most_px =
          std::max(most_px, largest_shift_px(table->at({zoom, focus}), zoom_lens(zoom, focus), 2));
    }
  EXPECT_LT(most_px, 0.1);  // 0.02 % of the way to the corner; linear in f it would be 12 px
}

TEST(LensTable, IsMonotoneWhereItsNodesAre) {
  std::vector<LensNode> nodes;
  using Pair = std::pair<double, double>;
  for (const auto& [zoom, f] : {Pair{0, 900}, Pair{1, 905}, Pair{2, 1700}, Pair{6, 1710}})
    nodes.push_back({{zoom, 0}, {{{kSize, f, f, 640, 512}, Lens()}, 0}, 0});
  const auto table = LensTable::make(nodes);
  ASSERT_TRUE(table) << table.error().context;
  double last = 0;
  for (int i = 0; i <= 600; ++i) {
    const double f = table->at({0.01 * i, 7}).camera.pinhole.fx_px;
    EXPECT_GE(f, last);
    EXPECT_GE(f, 900 - 1e-9);
    EXPECT_LE(f, 1710 + 1e-9);
    last = f;
  }
}

TEST(LensTable, TakesItsBorderForWhatLiesOutside) {
  const auto table = LensTable::make(nodes_of(3, {0, 1}));
  ASSERT_TRUE(table);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(table->contains({1000, 1}));
  for (const LensEncoders out : {LensEncoders{1000.1, 0.5}, {-1, 0.5}, {500, 1.1}, {nan, 0}})
    EXPECT_FALSE(table->contains(out));
  EXPECT_EQ(table->at({5000, 9}).camera.pinhole.fx_px, table->at({1000, 1}).camera.pinhole.fx_px);
  EXPECT_EQ(table->at({nan, nan}).camera.pinhole.fx_px, table->at({0, 0}).camera.pinhole.fx_px);
  const auto zoom_alone = LensTable::make(nodes_of(2, {0.5}));
  ASSERT_TRUE(zoom_alone);
  EXPECT_TRUE(zoom_alone->contains({0, 1e9}));
}

TEST(LensTable, RefusesWhatIsNoTable) {
  const auto refused = [](std::vector<LensNode> nodes, const char* why) {
    const auto table = LensTable::make(std::move(nodes));
    ASSERT_FALSE(table) << why;
    EXPECT_NE(table.error().context.find(why), std::string::npos) << table.error().context;
  };
  const auto good = nodes_of(3, {0, 1});
  refused({good[0]}, "two nodes or more");
  auto nodes = good;
  nodes.pop_back();
  refused(nodes, "not a grid");
  nodes = good;
  nodes[5].at = nodes[4].at;
  refused(nodes, "is there twice");
  nodes = good;
  nodes[1].at.zoom = std::numeric_limits<double>::infinity();
  refused(nodes, "must be finite");
  nodes = good;
  nodes[1].lens.camera.pinhole.size_px.width = 640;
  refused(nodes, "another size");
  nodes = good;
  nodes[2].lens.camera.pinhole.fx_px = -1;
  refused(nodes, "fx and fy must be positive");
  nodes = good;
  nodes[2].lens.camera.lens = Lens({-3, 0, 0, 0, 0, 0, 0, 0});
  refused(nodes, "folds");
}

TEST(LargestShift, SeesFocusAndPupil) {
  const LensState a{{{kSize, 1000, 1000, 639.5, 511.5}, Lens()}, 0};
  LensState b = a;
  EXPECT_LT(largest_shift_px(a, b, 2), 1e-9);
  b.camera.pinhole.fx_px = b.camera.pinhole.fy_px = 1010;
  EXPECT_NEAR(largest_shift_px(a, b, 2), 0.01 * std::hypot(639.5, 511.5), 1e-9);
  b = a;
  b.pupil_shift_m = 0.02;  // 2 m away are 1.98 m
  EXPECT_NEAR(largest_shift_px(a, b, 2), (2 / 1.98 - 1) * std::hypot(639.5, 511.5), 1e-9);
}

}  // namespace
}  // namespace mixrig::geometry
