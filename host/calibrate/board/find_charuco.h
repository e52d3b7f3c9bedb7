// SPDX-License-Identifier: Apache-2.0
// Finds a ChArUco board by its markers, in either of OpenCV's layouts. Private to this module.
#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "host/calibrate/board/detect_board.h"

namespace mixrig::calibration {

/// Markers of one picture: corners clockwise from the marker's own top left one.
struct FoundMarkers {
  std::vector<std::vector<cv::Point2f>> px;
  std::vector<int> ids;
};

/// Returns column and row of the square that holds a marker. `older`: the layout that OpenCV
/// printed before 4.6 for an even number of rows, whose top left square is white and holds marker
/// 0.
cv::Point square_of(int marker, const BoardSpec& board, bool older);

/// Returns true if the markers lie as in the older layout, false if they lie as in today's, nullopt
/// if they fit both: with an odd number of columns, where no marker at a side is seen.
std::optional<bool> is_older_layout(const FoundMarkers& found, const BoardSpec& board);

/// Finds the corners between the markers, not refined; nullopt if there are none. `dictionary` is
/// the number of OpenCV's predefined one. Throws cv::Exception.
std::optional<BoardView> find_charuco(const cv::Mat& image, const BoardSpec& board, int dictionary);

}  // namespace mixrig::calibration
