// SPDX-License-Identifier: Apache-2.0
// Calibration boards. The board's axes: x along the columns, y down the rows, z away from the
// viewer; the origin is point 0 of a checkerboard or ChArUco, the top left corner of an AprilGrid.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hal/base/result.h"

namespace mixrig::calibration {

enum class BoardKind { kCheckerboard, kCharuco, kAprilgrid };

struct BoardSpec {
  BoardKind kind = BoardKind::kCheckerboard;
  int columns = 9, rows = 6;  ///< inner corners (checkerboard), squares (ChArUco), tags (AprilGrid)
  double square_m = 0.025;    ///< side of a square; of a tag for an AprilGrid
  double marker_m = 0;        ///< ChArUco: side of a marker
  double gap_m = 0;           ///< AprilGrid: between tags
  std::string dictionary;     ///< ChArUco: OpenCV's name without DICT_, e.g. 5X5_250
  int first_tag = 0;          ///< AprilGrid: number of the tag at the bottom left, 36h11

  bool operator==(const BoardSpec&) const = default;
};

/// Parses "checkerboard:9x6:25mm", "charuco:14x9:40mm:30mm:5X5_250", "aprilgrid:6x6:88mm:26.4mm";
/// "aprilgrid:6x6:88mm:26.4mm:36" where the first tag is number 36. Errors: kUsage, with what is
/// wrong and the valid forms.
Result<BoardSpec> parse_board(std::string_view text);
/// The text that parse_board() reads.
std::string board_text(const BoardSpec& board);

/// Points by id, z = 0. Checkerboard: row by row from the first inner corner. ChArUco: the inner
/// corners likewise. AprilGrid: 4 a tag, the first at the bottom left and row by row upwards as
/// Kalibr prints it; bottom left, bottom right, top right, top left.
std::vector<Eigen::Vector3d> board_points_m(const BoardSpec& board);
/// Distance between neighbouring points: the square; the smaller of tag and gap for an AprilGrid.
double pitch_m(const BoardSpec& board);
/// Radius (m) of the area around a point that no edges cross but those of its own corner.
double clear_radius_m(const BoardSpec& board);

}  // namespace mixrig::calibration
