// SPDX-License-Identifier: Apache-2.0
// The board scenario: sensors agree with the truth, options, reproducible bytes.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "studio/board/board_poses.h"
#include "studio/board/board_studio.h"
#include "studio/sensors/lens.h"
#include "studio/srgb.h"

namespace mixrig::studio {
namespace {

BoardOptions small_board() {
  BoardOptions o;
  o.rig = RigPreset::kSr3000;
  o.seed = 5;
  o.views = 3;
  o.size_px = {320, 256};
  o.threads = 1;
  return o;
}

BoardStudio make(const BoardOptions& options) {
  auto studio = BoardStudio::create(options);
  EXPECT_TRUE(studio) << studio.error().context;
  return std::move(studio).value();
}

template <typename T>
bool same(const Image<T>& a, const Image<T>& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y)
    if (std::memcmp(a.row(y), b.row(y), sizeof(T) * static_cast<std::size_t>(a.width())) != 0)
      return false;
  return true;
}

TEST(Board, gives_the_same_bytes_in_any_order_and_on_two_threads) {
  BoardStudio one = make(small_board());
  BoardOptions options = small_board();
  options.threads = 2;
  BoardStudio two = make(options);
  BoardView a, b;
  one.render(1, a);
  one.render(2, a);
  two.render(2, b);
  EXPECT_TRUE(same(a.target, b.target));
  EXPECT_TRUE(same(a.fisheye, b.fisheye));
  EXPECT_TRUE(same(a.tof_distance_m, b.tof_distance_m));
  EXPECT_TRUE(same(a.tof_amplitude, b.tof_amplitude));
  options.seed = 6;
  BoardStudio other = make(options);
  other.render(2, b);
  EXPECT_FALSE(same(a.target, b.target));
}

/// The true projections of the square centres have the colour of the pattern.
TEST(Board, true_pose_projects_every_square_into_the_target_picture) {
  BoardOptions options = small_board();
  options.noise = 0;
  BoardStudio studio = make(options);
  const BoardPlan& plan = options.board;
  BoardView view;
  for (int n = 1; n <= 3; ++n) {
    studio.render(n, view);
    const auto seen = [&](int i, int j) {
      const Eigen::Vector3d centre((i + 0.5) * plan.square_m, (j + 0.5) * plan.square_m, 0);
      const Eigen::Vector2d px = project(studio.info().rig.target, view.target_from_board * centre);
      return linear_from_srgb(
          view.target
              .at(static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y())))
              .g);
    };
    // Light changes slowly over the board: ink is much darker than the adjacent paper.
    for (int j = 0; j < plan.rows; ++j)
      for (int i = 0; i + 1 < plan.columns; ++i)
        EXPECT_EQ(seen(i, j) < seen(i + 1, j), (i + j) % 2 == 0)
            << "view " << n << " square " << i << "," << j;
  }
}

TEST(Board, tof_distance_is_the_truth_plus_the_stated_error) {
  for (const double error_m : {0.0, 0.015}) {
    BoardOptions options = small_board();
    options.noise = 0;
    options.depth_error_m = error_m;
    BoardStudio studio = make(options);
    const TofSensor& tof = studio.info().rig.tof;
    BoardView view;
    studio.render(1, view);
    const geometry::Pose tof_from_board =
        geometry::inverse(tof.target_from_tof) * view.target_from_board;
    const BoardPlan& plan = options.board;
    for (int i = 1; i < plan.columns; i += 2) {  // white squares of the middle row
      const Eigen::Vector3d p =
          tof_from_board * Eigen::Vector3d((i + 0.5) * plan.square_m, 2.5 * plan.square_m, 0);
      const Eigen::Vector2d px = project(tof.optics, p);
      const int x = static_cast<int>(std::lround(px.x())),
                y = static_cast<int>(std::lround(px.y()));
      // The surface moves by up to half a pixel of 5 mm at 45 degrees.
      EXPECT_NEAR(view.tof_distance_m.at(x, y), p.norm() + depth_error_m(tof, p.norm()), 0.005);
    }
  }
}

TEST(Board, pan_tilt_stops_at_whole_steps_and_keeps_the_board_in_the_room) {
  BoardOptions options = small_board();
  options.pan_tilt = true;
  options.views = 12;
  BoardStudio studio = make(options);
  const PanTiltUnit& unit = studio.info().rig.pan_tilt;
  const auto rest_from_board = [&](int n) {
    const BoardPlace place = board_place(studio.info(), n);
    const double steps = place.pan_rad / unit.step_rad;
    EXPECT_NEAR(steps, std::round(steps), 1e-6);
    return rest_from_turned(unit, place.pan_rad, place.tilt_rad) * place.target_from_board;
  };
  const geometry::Pose first = rest_from_board(1);
  double widest = 0;
  for (int n = 2; n <= 12; ++n) {
    const geometry::Pose pose = rest_from_board(n);
    EXPECT_LT((pose.translation_m - first.translation_m).norm(), 6 * 1.7 * unit.repeatability_rad);
    EXPECT_LT(pose.rotation.angularDistance(first.rotation), 6 * unit.repeatability_rad);
    widest = std::max(widest, std::abs(board_place(studio.info(), n).pan_rad));
  }
  EXPECT_GT(widest, 0.08);
}

TEST(Board, bends_by_the_requested_amount) {
  BoardPlan plan;
  plan.bend_m = 0.004;
  EXPECT_NEAR(board_w_m(plan, 0), 0, 1e-12);
  EXPECT_NEAR(board_w_m(plan, 0.5 * plan.width_m()), -0.004, 1e-12);
}

TEST(Board, refuses_options_out_of_range) {
  const auto refused = [](auto change) {
    BoardOptions options = small_board();
    change(options);
    const auto studio = BoardStudio::create(options);
    return !studio && studio.error().code == ErrorCode::kUsage;
  };
  EXPECT_TRUE(refused([](BoardOptions& o) { o.views = 0; }));
  EXPECT_TRUE(refused([](BoardOptions& o) { o.size_px = {10, 10}; }));
  EXPECT_TRUE(refused([](BoardOptions& o) { o.noise = -1; }));
  EXPECT_TRUE(refused([](BoardOptions& o) { o.blur_px = std::nan(""); }));
  EXPECT_TRUE(refused([](BoardOptions& o) {
    o.board.kind = BoardKind::kCharuco;
    o.board.columns = 20, o.board.rows = 20;
  }));
}

}  // namespace
}  // namespace mixrig::studio
