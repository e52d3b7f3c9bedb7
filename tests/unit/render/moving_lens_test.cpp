// SPDX-License-Identifier: Apache-2.0
// A lens that moves: the compositor that follows it against one that is made for each of its
// settings, and its tables against the camera model.
#include <cmath>
#include <optional>

#include "host/math/geometry/lens_table.h"
#include "host/render/cpu/compositor_cpu.h"
#include "host/render/frame/picture_look.h"
#include "tests/gl/room_setup.h"
#include "tests/support/count_allocations.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

geometry::LensState zoomed(const render::CompositorSetup& setup, double zoom, double shift_m) {
  geometry::LensState lens{setup.target, shift_m};
  geometry::Pinhole& p = lens.camera.pinhole;
  p.fx_px *= zoom, p.fy_px *= zoom;
  p.cx_px += 3 * (zoom - 1), p.cy_px -= 2 * (zoom - 1);
  lens.camera.lens = geometry::Lens({-0.1 + 0.15 * zoom, 0, 1e-3, -1e-3, 0, 0, 0, 0});
  return lens;
}

/// The room with its lens free to move.
struct LensRoom : RoomSetup {
  LensRoom() : RoomSetup(Options{.view = {327, 245}, .lens_k1 = -0.08}) {
    draw_background_for_each_pose();
    setup.lens_moves = true;
  }
  render::FrameInput with(const geometry::LensState& lens) const {
    render::FrameInput input = frame();
    input.lens = lens;
    input.look = &look;
    return input;
  }
  /// Edges are as wide as those of the first plate, which other compositors see through other
  /// lenses: all of them are told the same.
  render::PictureLook look{.grain = {}, .blur_px = 0.4F};
};

/// The same frame drawn by a compositor whose lens is fixed to `lens`.
render::FrameOutput made_for(const LensRoom& room, const geometry::LensState& lens) {
  render::CompositorSetup setup = room.setup;
  setup.view = render::view_through(room.setup, lens.camera.pinhole);
  setup.target = lens.camera;
  setup.target_from_tof =
      geometry::inverse(geometry::at_pupil({}, lens.pupil_shift_m)) * setup.target_from_tof;
  render::FrameInput input = room.frame();
  input.look = &room.look;
  input.world_from_target = geometry::at_pupil(input.world_from_target, lens.pupil_shift_m);
  auto compositor = render::make_cpu_compositor(setup, 2);
  EXPECT_TRUE(compositor) << compositor.error().context;
  render::FrameOutput out;
  out.wanted = render::kAll;
  if (compositor && !(*compositor)->compose(input, out)) ADD_FAILURE();
  return out;
}

template <typename T>
std::size_t differing(const Image<T>& a, const Image<T>& b) {
  std::size_t count = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) count += !(a.at(x, y) == b.at(x, y));
  return count;
}

void expect_same(const render::FrameOutput& a, const render::FrameOutput& b) {
  EXPECT_EQ(differing(a.color, b.color), 0U);
  EXPECT_EQ(differing(a.mixed_depth_m, b.mixed_depth_m), 0U);
  EXPECT_EQ(differing(a.segmented_depth_m, b.segmented_depth_m), 0U);
  EXPECT_EQ(differing(a.matte, b.matte), 0U);
  EXPECT_EQ(differing(a.light, b.light), 0U);
  EXPECT_EQ(differing(a.layer, b.layer), 0U);
}

TEST(MovingLens, FollowsAsIfMadeForEachSetting) {
  const LensRoom room;
  auto compositor = render::make_cpu_compositor(room.setup, 2);
  ASSERT_TRUE(compositor) << compositor.error().context;
  render::FrameOutput out;
  out.wanted = render::kAll;
  render::FrameOutput first;
  for (const auto& [zoom, shift_m] :
       {std::pair(1.0, 0.0), std::pair(1.7, 0.02), std::pair(1.2, -0.01), std::pair(1.0, 0.0)}) {
    const geometry::LensState lens = zoomed(room.setup, zoom, shift_m);
    ASSERT_TRUE((*compositor)->compose(room.with(lens), out));
    expect_same(out, made_for(room, lens));
    if (first.color.empty()) first = out;
    if (zoom > 1) {
      EXPECT_GT(differing(out.color, first.color), out.color.size().area() / 4);
    }
  }
  // A frame without a lens of its own uses that of the setup.
  ASSERT_TRUE((*compositor)->compose(room.frame(), out));
  expect_same(out, made_for(room, {room.setup.target, 0}));
}

TEST(MovingLens, AllocatesNothingAndRestsWhenItStandsStill) {
  const LensRoom room;
  auto compositor = render::make_cpu_compositor(room.setup, 1);
  ASSERT_TRUE(compositor);
  render::FrameOutput out;
  for (const double zoom : {1.0, 1.6, 1.3})
    ASSERT_TRUE((*compositor)->compose(room.with(zoomed(room.setup, zoom, 0.01)), out));
  const render::FrameInput next = room.with(zoomed(room.setup, 1.5, 0.02));
  const long before = allocations;
  ASSERT_TRUE((*compositor)->compose(next, out));
  EXPECT_EQ(allocations - before, 0);
  const auto time_ms = [&](render::Stage stage) {
    return (*compositor)->state().stage_times[static_cast<std::size_t>(stage)];
  };
  EXPECT_GT(time_ms(render::Stage::kBackground), 0);
  ASSERT_TRUE((*compositor)->compose(next, out));
  EXPECT_EQ(time_ms(render::Stage::kBackground), 0);  // nothing was drawn again
  EXPECT_EQ(time_ms(render::Stage::kVirtual), 0);
}

TEST(MovingLens, IsRefusedWhereItIsNotExpected) {
  LensRoom room;
  render::FrameOutput out;
  render::FrameInput frame = room.with(zoomed(room.setup, 1.5, 0));
  auto compositor = render::make_cpu_compositor(room.setup, 1);
  ASSERT_TRUE(compositor);
  frame.lens->camera.pinhole.fx_px = -1;
  EXPECT_FALSE((*compositor)->compose(frame, out));
  frame.lens->camera = zoomed(room.setup, 1.5, 0).camera;
  frame.lens->pupil_shift_m = std::nan("");
  EXPECT_FALSE((*compositor)->compose(frame, out));
  frame.lens->pupil_shift_m = 0;
  frame.lens->camera.pinhole.size_px.width += 1;
  EXPECT_FALSE((*compositor)->compose(frame, out));
  EXPECT_TRUE((*compositor)->compose(room.frame(), out));
  room.setup.lens_moves = false;
  auto fixed = render::make_cpu_compositor(room.setup, 1);
  ASSERT_TRUE(fixed);
  EXPECT_FALSE((*fixed)->compose(room.with(zoomed(room.setup, 1.5, 0)), out));
  RoomSetup still(RoomSetup::Options{});
  still.setup.lens_moves = true;
  const auto refused = render::make_cpu_compositor(still.setup, 1);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().context.find("still background"), std::string::npos);
}

TEST(MovingLens, ViewChangesAsTheLensDoes) {
  render::CompositorSetup setup;
  setup.target.pinhole = {{640, 480}, 500, 510, 320, 240};
  setup.view = {{320, 240}, 260, 265, 159, 119};
  const geometry::Pinhole view = render::view_through(setup, {{640, 480}, 1000, 765, 324, 230});
  EXPECT_DOUBLE_EQ(view.fx_px, 520);
  EXPECT_DOUBLE_EQ(view.fy_px, 265 * 1.5);
  EXPECT_DOUBLE_EQ(view.cx_px, 161);
  EXPECT_DOUBLE_EQ(view.cy_px, 114);
  EXPECT_EQ(view.size_px, setup.view.size_px);
}

TEST(PlateRow, ProjectsEachPixelThroughTheLens) {
  const geometry::Pinhole view{{180, 120}, 30, 31, 90, 60};  // so wide that a lens folds in it
  Image<glm::vec2> row({view.size_px.width, 1});
  int unseen = 0;
  for (const geometry::Lens::Coefficients& k :
       {geometry::Lens::Coefficients{-0.3, 0.05, 2e-3, -1e-3, 0.01, 0.02, 0.01, 0.003},
        geometry::Lens::Coefficients{-0.3, 0, 2e-3, -1e-3, 0, 0, 0, 0}}) {
    const geometry::CameraModel lens{{{200, 160}, 150, 155, 98, 81}, geometry::Lens(k)};
    for (int y = 0; y < view.size_px.height; ++y) {
      render::plate_row(lens, view, y, row.row(0));
      for (int x = 0; x < view.size_px.width; ++x) {
        const Eigen::Vector2d ray = view.unproject(Eigen::Vector2d(x, y));
        const auto px = lens.project({ray.x(), ray.y(), 1});
        unseen += !px;
        ASSERT_NEAR(row.at(x, 0).x, px ? px->x() : 0, 1e-3) << x << " " << y;
        ASSERT_NEAR(row.at(x, 0).y, px ? px->y() : 0, 1e-3) << x << " " << y;
      }
    }
  }
  EXPECT_GT(unseen, 0);
}

}  // namespace
}  // namespace mixrig::test
