// SPDX-License-Identifier: Apache-2.0
// Positions of the four borders of a box before a wall after the warp, by formula: no side is
// favoured.
#include <algorithm>
#include <cmath>

#include "host/render/cpu/warp/warp.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kBoxTof{32, 32}, kBoxView{512, 512};  // a ToF pixel spans 16 px of the view
constexpr double kBoxTofFocal = 32, kBoxViewFocal = 512;
constexpr float kBoxM = 2, kBoxWallM = 4;

/// Share of the ToF pixel around `at` that lies between -half and half of it, 0 to 1.
double share_within(double at, double half) {
  return std::clamp(std::min(at + 0.5, half) - std::max(at - 0.5, -half), 0.0, 1.0);
}

/// ToF depth of a square box before a wall, `half_px` of its pixels to each side of its axis. A
/// pixel that sees both has the depth of the sum of their light, which falls with the square of the
/// depth; if `mixes` is false, it has none.
Image<float> box_before_wall(double half_px, bool mixes) {
  const double middle = 0.5 * (kBoxTof.width - 1);
  return make_image<float>(kBoxTof, [&](int x, int y) {
    const double share = share_within(x - middle, half_px) * share_within(y - middle, half_px);
    if (!mixes) return share > 0 && share < 1 ? 0.0F : share > 0 ? kBoxM : kBoxWallM;
    const double near = share / (kBoxM * kBoxM), far = (1 - share) / (kBoxWallM * kBoxWallM);
    return static_cast<float>((near * kBoxM + far * kBoxWallM) / (near + far));
  });
}

/// The rig: a ToF camera at (x_m, y_m) of the camera, and a box `half_px` ToF pixels to each side
/// of its axis.
struct BoxRig {
  double x_m = 0, y_m = 0, half_px = 6;
  double u_px() const { return 0.5 * (kBoxView.width - 1) + kBoxViewFocal * x_m / kBoxM; }
  double v_px() const { return 0.5 * (kBoxView.height - 1) + kBoxViewFocal * y_m / kBoxM; }
};
constexpr double kStepPx = kBoxViewFocal / kBoxTofFocal;

/// ToF pixels by which the warped box reaches past its true borders.
struct BoxBorders {
  double left = 0, right = 0, top = 0, bottom = 0;
};

BoxBorders borders_of(const BoxRig& rig, bool mixes) {
  render::CompositorSetup setup = plain_setup(kBoxView, kBoxViewFocal, kBoxTof, kBoxTofFocal);
  setup.target_from_tof.translation_m = {rig.x_m, rig.y_m, 0};
  const render::Tables tables = render::make_tables(setup);
  Crew crew(1);
  render::cpu::TofGrid grid(kBoxTof);
  render::cpu::WarpScratch scratch(kBoxTof);
  Image<float> w(
      {kBoxView.width + render::cpu::kViewMargin, kBoxView.height + render::cpu::kViewMargin});
  render::cpu::correct(crew, tables.correct, tables.tof_ray, box_before_wall(rig.half_px, mixes),
                       grid);
  render::cpu::warp(crew, tables, grid, scratch, w);
  const auto near = [&](int x, int y) { return w.at(x, y) > 0.4F; };
  const int u = static_cast<int>(rig.u_px()), v = static_cast<int>(rig.v_px());
  int x0 = u, x1 = u, y0 = v, y1 = v;
  while (near(x0 - 1, v)) --x0;
  while (near(x1 + 1, v)) ++x1;
  while (near(u, y0 - 1)) --y0;
  while (near(u, y1 + 1)) ++y1;
  const auto past = [&](double reached_px) { return reached_px / kStepPx - rig.half_px; };
  return {past(rig.u_px() - (x0 - 0.5)), past(x1 + 0.5 - rig.u_px()), past(rig.v_px() - (y0 - 0.5)),
          past(y1 + 0.5 - rig.v_px())};
}

/// Mean over boxes whose borders lie at all places of a ToF pixel.
BoxBorders mean_borders(double x_m, double y_m, bool mixes) {
  constexpr int kSizes = 16;
  BoxBorders mean;
  for (int k = 0; k < kSizes; ++k) {
    const BoxBorders b = borders_of({x_m, y_m, 6 + (k + 0.5) / kSizes}, mixes);
    mean.left += b.left / kSizes, mean.right += b.right / kSizes;
    mean.top += b.top / kSizes, mean.bottom += b.bottom / kSizes;
  }
  return mean;
}

class WarpBorders : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Pixels, WarpBorders, testing::Bool(),
                         [](const auto& p) { return p.param ? "mix" : "measure_nothing"; });

constexpr double kNearPx = 0.05;  // ToF pixels; a pixel of the view is 0.06

TEST_P(WarpBorders, without_parallax_all_sides_lie_where_they_are) {
  const BoxBorders b = mean_borders(0, 0, GetParam());
  for (const double past : {b.left, b.right, b.top, b.bottom}) EXPECT_NEAR(past, 0, kNearPx);
}

TEST_P(WarpBorders, sides_are_alike_wherever_the_tof_camera_stands) {
  constexpr double kApartM = 0.1;  // 0.8 ToF pixels of parallax
  const BoxBorders right = mean_borders(kApartM, 0, GetParam());
  const BoxBorders left = mean_borders(-kApartM, 0, GetParam());
  const BoxBorders below = mean_borders(0, kApartM, GetParam());
  const BoxBorders above = mean_borders(0, -kApartM, GetParam());
  // Past these borders the camera sees what the ToF camera does not.
  EXPECT_LT(right.left, -0.1);
  for (const double past : {left.right, below.top, above.bottom})
    EXPECT_NEAR(past, right.left, kNearPx);
  // These cover what the ToF camera sees.
  EXPECT_GT(right.right, 0.05);
  for (const double past : {left.left, below.bottom, above.top})
    EXPECT_NEAR(past, right.right, kNearPx);
  for (const double past : {right.top, right.bottom, left.top, left.bottom, below.left, below.right,
                            above.left, above.right})
    EXPECT_NEAR(past, 0, kNearPx);
}

}  // namespace
}  // namespace mixrig::test
