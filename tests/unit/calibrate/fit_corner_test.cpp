// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/fit_corner.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/unit/calibrate/drawn_board.h"

namespace mixrig::calibration {
namespace {

using Eigen::Vector2d;

struct Errors {
  double ours = 0, opencv = 0, stated = 0;  ///< root mean square over x and y, px
  int count = 0;
};

/// Corners of a tilted board behind a bent lens, by both methods, from starts that are off by 0.4
/// px.
Errors measure(const test::DrawnLook& look, int views) {
  const BoardSpec board = *parse_board("checkerboard:9x6:25mm");
  const test::DrawnCamera camera;
  Errors sum;
  const auto poses = test::varied_poses(board, views, 3, 0.42);
  for (std::size_t v = 0; v < poses.size(); ++v) {
    const auto image = test::draw_board(board, camera, poses[v], look, static_cast<unsigned>(v));
    const cv::Mat mat(image.height(), image.width(), CV_8UC1,
                      const_cast<std::uint8_t*>(image.row(0)),
                      static_cast<std::size_t>(image.stride()));
    const auto truth = test::true_px(board, camera, poses[v]);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (i % 9 == 8 || i >= 45) continue;
      const double turn = static_cast<double>(i);
      const Vector2d start = truth[i] + 0.4 * Vector2d(std::sin(7 * turn), std::cos(5 * turn));
      const auto fit =
          fit_corner(image, start, truth[i + 1] - truth[i], truth[i + 9] - truth[i], 8);
      if (!fit) continue;  // too near to the picture's edge
      std::vector<cv::Point2f> px{{static_cast<float>(start.x()), static_cast<float>(start.y())}};
      cv::cornerSubPix(mat, px, {5, 5}, {-1, -1},
                       {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 1e-3});
      sum.ours += (fit->px - truth[i]).squaredNorm();
      sum.opencv += (Vector2d(px[0].x, px[0].y) - truth[i]).squaredNorm();
      sum.stated += 2 * fit->sigma_px * fit->sigma_px;
      ++sum.count;
    }
  }
  for (double* value : {&sum.ours, &sum.opencv, &sum.stated})
    *value = std::sqrt(*value / (2 * sum.count));
  return sum;
}

TEST(FitCorner, BeatsOpencvUnderNoiseAndKnowsItsSigma) {
  for (const double noise : {1.0, 4.0, 10.0}) {
    test::DrawnLook look;
    look.noise = noise;
    const Errors e = measure(look, 4);
    std::printf("noise %4.1f: fit %.4f px (stated %.4f), cornerSubPix %.4f px, %d corners\n", noise,
                e.ours, e.stated, e.opencv, e.count);
    ASSERT_GT(e.count, 100);
    EXPECT_LT(e.ours, 0.8 * e.opencv);
    EXPECT_LT(e.ours, 1.3 * e.stated);
  }
}

TEST(FitCorner, StandsBlurAndHasNoBias) {
  for (const double blur : {0.3, 1.0, 2.0}) {
    test::DrawnLook look;
    look.noise = 0;
    look.blur_px = blur;
    const Errors e = measure(look, 3);
    std::printf("blur %3.1f: fit %.4f px, cornerSubPix %.4f px\n", blur, e.ours, e.opencv);
    EXPECT_LT(e.ours, 0.02);
  }
}

TEST(FitCorner, MeasuresTheBlur) {
  const BoardSpec board = *parse_board("checkerboard:9x6:25mm");
  test::DrawnCamera camera;
  camera.k = 0;
  test::DrawnLook look;
  look.blur_px = 1.5;
  const auto pose = test::board_pose(board, {0, 0, 0.2}, {0, 0, 0.4});
  const auto image = test::draw_board(board, camera, pose, look, 1);
  const auto truth = test::true_px(board, camera, pose);
  const auto fit = fit_corner(image, truth[20], truth[21] - truth[20], truth[29] - truth[20], 10);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->blur_px, std::hypot(1.5, 0.29), 0.1);
}

TEST(FitCorner, RefusesWhatIsNoCorner) {
  Image<std::uint8_t> flat({64, 64}, 100), edge({64, 64}, 0);
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 64; ++x) edge.at(x, y) = 200;
  const Vector2d right(1, 0), down(0, 1);
  EXPECT_FALSE(fit_corner(flat, {32, 32}, right, down, 8));
  EXPECT_FALSE(fit_corner(edge, {31.5, 32}, right, down, 8));
  EXPECT_FALSE(fit_corner(flat, {3, 32}, right, down, 8));    // out of the picture
  EXPECT_FALSE(fit_corner(flat, {32, 32}, right, right, 8));  // no two edges
  EXPECT_FALSE(fit_corner(flat, {NAN, 32}, right, down, 8));
  EXPECT_FALSE(fit_corner(flat, {32, 32}, right, down, 1));
}

}  // namespace
}  // namespace mixrig::calibration
