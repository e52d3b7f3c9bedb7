// SPDX-License-Identifier: Apache-2.0
// Angles that are wrong are found from the pictures of a box.
#include "host/room/scan/panorama/view_alignment.h"

#include <gtest/gtest.h>

#include "hal/base/angles.h"
#include "tests/support/box_views.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

constexpr double kLeast_rad = 0.05 * kDeg;

Alignment aligned(const std::vector<ScanView>& views) {
  Crew crew(2);
  return align(views, test::box_camera(), test::box_camera(), kLeast_rad, crew);
}

std::vector<ScanView> noisy_box(bool textured = true) {
  return test::box_views({.noise_m = 0.006, .textured = textured});
}

TEST(ViewAlignment, RightAnglesStay) {
  const Alignment result = aligned(noisy_box());
  EXPECT_GT(result.samples, 5000);
  EXPECT_LT(result.median_m, 0.01);
  EXPECT_GT(result.median_m, 0.002);
  EXPECT_LT(result.p95_m, 0.03);
  for (const ViewAgreement& view : result.views) {
    EXPECT_GT(view.samples, 100);
    EXPECT_EQ(view.turn_rad, Vector3d::Zero());
  }
}

TEST(ViewAlignment, OneWrongAngleIsFoundAndMended) {
  for (const std::size_t wrong : {4U, 23U, 47U})  // near a pole, ahead, near the other
    for (const bool textured : {false, true}) {
      const Vector3d error_rad = Vector3d(0.3, -0.2, 0.4) * kDeg;
      std::vector<ScanView> views = noisy_box(textured);
      turn(error_rad, views[wrong]);
      const Alignment result = aligned(views);
      for (std::size_t i = 0; i < views.size(); ++i) {
        Vector3d off_rad = result.views[i].turn_rad;
        if (i == wrong) off_rad += error_rad;
        // A plain floor or ceiling that fills a view does not determine a turn about z.
        if (!textured && wrong != 23) off_rad.z() = 0;
        EXPECT_LT(off_rad.norm(), 0.05 * kDeg)
            << i << " of " << wrong << (textured ? " textured" : " plain");
      }
      EXPECT_LT(result.views[wrong].aligned_m, result.views[wrong].median_m);
    }
}

/// No unit has such errors: something else is wrong, and turns would only hide it.
TEST(ViewAlignment, WhereMostViewsWouldTurnNoneDoes) {
  std::vector<ScanView> views = noisy_box();
  for (std::size_t i = 0; i < views.size(); ++i)
    turn(Vector3d(i % 2 == 0 ? 1.5 : -1.5, 0, i % 3 == 0 ? 1.5 : -1.5) * kDeg, views[i]);
  const Alignment result = aligned(views);
  EXPECT_TRUE(result.refused);
  EXPECT_GT(result.median_turn_rad, 0.5 * kDeg);
  for (const ViewAgreement& view : result.views) EXPECT_EQ(view.turn_rad, Vector3d::Zero());
}

TEST(ViewAlignment, PeopleTurnNoView) {
  std::vector<ScanView> views = noisy_box();
  for (const std::size_t i : {3U, 14U, 25U, 36U})
    for (int y = 20; y < 80; ++y)
      for (int x = 30; x < 55; ++x) {
        views[i].distance_m.at(x, y) = 1.4F;
        views[i].plate.at(x, y) = {20, 30, 90};
      }
  for (const ViewAgreement& view : aligned(views).views) EXPECT_EQ(view.turn_rad, Vector3d::Zero());
}

TEST(ViewAlignment, WhereNothingOverlapsNothingIsSaid) {
  const std::vector<ScanView> apart{test::box_view(0, 0), test::box_view(M_PI, 0)};
  const Alignment result = aligned(apart);
  EXPECT_EQ(result.samples, 0);
  for (const ViewAgreement& view : result.views) {
    EXPECT_EQ(view.samples, 0);
    EXPECT_EQ(view.turn_rad, Vector3d::Zero());
  }
  EXPECT_TRUE(aligned({}).views.empty());
}

TEST(ViewAlignment, ViewsWithoutColourAreAlignedByTheirDepth) {
  std::vector<ScanView> views = noisy_box(false);
  for (ScanView& view : views) view.plate = {};
  turn(Vector3d(0, 0, 0.5) * kDeg, views[22]);
  const Alignment result = aligned(views);
  EXPECT_NEAR(result.views[22].turn_rad.z(), -0.5 * kDeg, 0.05 * kDeg);
}

}  // namespace
}  // namespace mixrig::model
