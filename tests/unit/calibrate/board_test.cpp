// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/board.h"

#include <gtest/gtest.h>

namespace mixrig::calibration {
namespace {

TEST(Board, ReadsAndWritesItsWords) {
  const BoardSpec checkerboard{BoardKind::kCheckerboard, 9, 6, 0.025, 0, 0, ""};
  const BoardSpec charuco{BoardKind::kCharuco, 14, 9, 0.04, 0.03, 0, "5X5_250"};
  const BoardSpec aprilgrid{BoardKind::kAprilgrid, 6, 6, 0.088, 0, 0.0264, ""};
  const BoardSpec later{BoardKind::kAprilgrid, 6, 6, 0.088, 0, 0.0264, "", 36};
  for (const auto& [text, board] : {std::pair("checkerboard:9x6:25mm", checkerboard),
                                    std::pair("charuco:14x9:40mm:30mm:5X5_250", charuco),
                                    std::pair("aprilgrid:6x6:88mm:26.4mm", aprilgrid),
                                    std::pair("aprilgrid:6x6:88mm:26.4mm:36", later)}) {
    const auto read = parse_board(text);
    ASSERT_TRUE(read) << read.error().context;
    EXPECT_EQ(*read, board);
    EXPECT_EQ(board_text(*read), text);
  }
  EXPECT_EQ(parse_board("checkerboard:9x6:2.5cm")->square_m, 0.025);
  EXPECT_EQ(parse_board("checkerboard:9x6:0.025m")->square_m, 0.025);
}

TEST(Board, RefusesWhatIsNoBoard) {
  for (const char* text :
       {"", "chessboard:9x6:25mm", "checkerboard:9x6", "checkerboard:9x6:25", "checkerboard:9:25mm",
        "checkerboard:9x6x2:25mm", "checkerboard:2x6:25mm", "checkerboard:-9x6:25mm",
        "checkerboard:9x6:-25mm", "checkerboard:9x6:nanmm", "checkerboard:999x6:25mm",
        "charuco:14x9:40mm:30mm", "charuco:14x9:40mm:40mm:5X5_250", "aprilgrid:6x6:88mm",
        "aprilgrid:6x6:88mm:26mm:552", "aprilgrid:6x6:88mm:26mm:-1", "aprilgrid:6x6:88mm:26mm:0:0",
        "aprilgrid:25x25:88mm:26mm"}) {
    const auto read = parse_board(text);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().code, ErrorCode::kUsage);
  }
}

TEST(Board, PlacesItsPoints) {
  const auto inner = board_points_m(*parse_board("checkerboard:9x6:25mm"));
  ASSERT_EQ(inner.size(), 54U);
  EXPECT_EQ(inner[9], Eigen::Vector3d(0, 0.025, 0));
  EXPECT_EQ(board_points_m(*parse_board("charuco:14x9:40mm:30mm:5X5_250")).size(), 13U * 8U);
  const auto tags = board_points_m(*parse_board("aprilgrid:2x3:80mm:20mm"));
  ASSERT_EQ(tags.size(), 24U);
  EXPECT_LT((tags[0] - Eigen::Vector3d(0, 0.28, 0)).norm(), 1e-12);   // bottom left of the lowest
  EXPECT_LT((tags[22] - Eigen::Vector3d(0.18, 0, 0)).norm(), 1e-12);  // top right of the highest
}

}  // namespace
}  // namespace mixrig::calibration
