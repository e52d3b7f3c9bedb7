// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/detect_board.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/calibrate/drawn_board.h"

namespace mixrig::calibration {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Greatest distance of a found point from where it really is, px.
double worst_px(const BoardView& view, const std::vector<Vector2d>& truth) {
  double worst = 0;
  for (std::size_t i = 0; i < view.ids.size(); ++i)
    worst = std::max(worst, (view.px[i] - truth[static_cast<std::size_t>(view.ids[i])]).norm());
  return worst;
}

struct Case {
  const char* board;
  double distance_m;
  std::size_t least;
};

TEST(DetectBoard, FindsEveryKindWithItsIds) {
  for (const Case& c :
       {Case{"checkerboard:9x6:25mm", 0.42, 54}, Case{"charuco:9x6:30mm:20mm:5X5_250", 0.42, 36},
        Case{"charuco:8x6:30mm:20mm:5X5_250", 0.42, 30}, Case{"aprilgrid:4x3:60mm:18mm", 0.5, 30},
        Case{"aprilgrid:4x3:60mm:18mm:36", 0.5, 30}}) {
    const BoardSpec board = *parse_board(c.board);
    const test::DrawnCamera camera;
    for (const Vector3d& turn :
         {Vector3d(0, 0, 0), Vector3d(0.4, -0.2, 0.1), Vector3d(-0.3, 0.4, 1.4)}) {
      const auto pose = test::board_pose(board, turn, {0.01, 0, c.distance_m});
      const auto image = test::draw_board(board, camera, pose, {}, 7);
      const auto view = detect_board(image, board);
      ASSERT_TRUE(view) << view.error().context;
      ASSERT_TRUE(*view) << c.board << " " << turn.transpose();
      EXPECT_GE((*view)->ids.size(), c.least) << c.board << " " << turn.transpose();
      EXPECT_LT(worst_px(**view, test::true_px(board, camera, pose)), 0.25)
          << c.board << " " << turn.transpose();
      EXPECT_NEAR((*view)->blur_px, 0.67, 0.25);
    }
  }
}

/// Finds a board that is printed in one of the layouts, and compares it with where it really is.
std::optional<BoardView> found_as_printed(const char* text, bool older, const Vector3d& turn,
                                          const Vector3d& middle_m) {
  const BoardSpec board = *parse_board(text);
  const test::DrawnCamera camera;
  test::DrawnLook look;
  look.first_is_white = older;
  const auto pose = test::board_pose(board, turn, middle_m);
  const auto view = detect_board(test::draw_board(board, camera, pose, look, 5), board);
  EXPECT_TRUE(view && *view) << text << " " << turn.transpose();
  if (!view || !*view) return std::nullopt;
  EXPECT_EQ((*view)->first_is_white, older) << text << " " << turn.transpose();
  EXPECT_LT(worst_px(**view, test::true_px(board, camera, pose)), 0.25)
      << text << " " << turn.transpose();
  return *view;
}

TEST(DetectBoard, TellsTheLayoutsOfACharucoApart) {
  for (const char* text : {"charuco:9x6:30mm:20mm:5X5_250", "charuco:8x6:30mm:22mm:5X5_250",
                           "charuco:7x6:30mm:20mm:5X5_250", "charuco:5x8:25mm:18mm:5X5_250"})
    for (const bool older : {false, true})
      for (const Vector3d& turn : {Vector3d(0.4, -0.2, 0.1), Vector3d(-0.3, 0.4, 2.9)}) {
        const auto view = found_as_printed(text, older, turn, {0.01, 0, 0.42});
        const BoardSpec board = *parse_board(text);
        ASSERT_TRUE(view);
        EXPECT_GE(view->ids.size(), 0.9 * (board.columns - 1) * (board.rows - 1)) << text;
      }
  // An odd number of rows has one layout.
  EXPECT_TRUE(found_as_printed("charuco:8x5:30mm:20mm:5X5_250", false, {0.2, 0.1, 0}, {0, 0, 0.4}));
}

TEST(DetectBoard, DoesNotGuessTheLayoutWhereOnlyTheMiddleOfAnOddCharucoIsSeen) {
  const test::DrawnCamera camera;
  const BoardSpec board = *parse_board("charuco:15x6:30mm:22mm:5X5_250");
  const auto pose = test::board_pose(board, {0.1, 0.1, 0}, {0, 0, 0.22});
  for (const bool older : {false, true}) {
    test::DrawnLook look;
    look.first_is_white = older;
    const auto view = detect_board(test::draw_board(board, camera, pose, look, 5), board);
    ASSERT_TRUE(view && *view);
    EXPECT_FALSE((*view)->first_is_white);  // no value
    auto truth = test::true_px(board, camera, pose);
    if (older) truth.insert(truth.begin(), truth.front());  // ids count from the column before
    EXPECT_LT(worst_px(**view, truth), 0.25);
  }
  // Even columns are told by any two rows.
  EXPECT_TRUE(
      found_as_printed("charuco:14x6:30mm:22mm:5X5_250", true, {0.1, 0.1, 0}, {0, 0, 0.22}));
}

TEST(DetectBoard, KeepsTheOrderOfACheckerboardUpsideDown) {
  const BoardSpec board = *parse_board("checkerboard:9x6:25mm");
  const test::DrawnCamera camera;
  for (const double turn : {0.0, 1.0, 2.0, 3.1, 4.4, 5.5}) {
    const auto pose = test::board_pose(board, {0, 0, turn}, {0, 0, 0.55});
    const auto view = detect_board(test::draw_board(board, camera, pose, {}, 1), board);
    ASSERT_TRUE(view && *view) << turn;
    EXPECT_LT(worst_px(**view, test::true_px(board, camera, pose)), 0.25) << turn;
  }
}

TEST(DetectBoard, SeesACharucoInPartButNotHalfACheckerboard) {
  const test::DrawnCamera camera;
  const BoardSpec charuco = *parse_board("charuco:9x6:30mm:20mm:5X5_250");
  const auto aside = test::board_pose(charuco, {0.1, 0.2, 0}, {0.2, 0.05, 0.4});
  const auto part = detect_board(test::draw_board(charuco, camera, aside, {}, 1), charuco);
  ASSERT_TRUE(part && *part);
  EXPECT_LT((*part)->ids.size(), 36U);
  EXPECT_LT(worst_px(**part, test::true_px(charuco, camera, aside)), 0.25);
  const BoardSpec checkerboard = *parse_board("checkerboard:9x6:25mm");
  const auto half = test::board_pose(checkerboard, {0.1, 0.2, 0}, {0.25, 0, 0.4});
  const auto nothing =
      detect_board(test::draw_board(checkerboard, camera, half, {}, 1), checkerboard);
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(*nothing);
}

TEST(DetectBoard, FindsNothingInNothing) {
  const Image<std::uint8_t> flat({320, 240}, 128);
  for (const char* text :
       {"checkerboard:9x6:25mm", "charuco:9x6:30mm:20mm:5X5_250", "aprilgrid:4x3:60mm:18mm"}) {
    const auto view = detect_board(flat, *parse_board(text));
    ASSERT_TRUE(view) << view.error().context;
    EXPECT_FALSE(*view);
  }
  EXPECT_FALSE(detect_board(flat, *parse_board("charuco:9x6:30mm:20mm:9X9_9")));
  EXPECT_FALSE(*detect_board({}, *parse_board("checkerboard:9x6:25mm")));
}

TEST(GrayOf, WeighsColoursAndStretches16Bits) {
  Image<Rgb8> color({2, 1});
  color.at(0, 0) = {255, 255, 255};
  color.at(1, 0) = {0, 100, 0};
  EXPECT_EQ(gray_of(color).at(0, 0), 255);
  EXPECT_EQ(gray_of(color).at(1, 0), 71);
  Image<std::uint16_t> deep({256, 4});
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 256; ++x) deep.at(x, y) = static_cast<std::uint16_t>(1000 + 20 * x);
  const auto gray = gray_of(deep);
  EXPECT_EQ(gray.at(0, 0), 0);
  EXPECT_EQ(gray.at(255, 3), 255);
  EXPECT_NEAR(gray.at(128, 2), 128, 2);
}

}  // namespace
}  // namespace mixrig::calibration
