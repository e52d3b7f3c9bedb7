// SPDX-License-Identifier: Apache-2.0
// Finds a calibration board in a picture.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/calibrate/board/board.h"

namespace mixrig::calibration {

/// Points of a board in one picture, by growing id.
struct BoardView {
  std::vector<int> ids;             ///< the points' ids: indices of board_points_m()
  std::vector<Eigen::Vector2d> px;  ///< (0, 0) is the centre of the top-left pixel
  double blur_px = 0;               ///< median standard deviation of the corners' blur
  double contrast = 0;              ///< median, grey levels from black to white
  double sigma_px = 0;              ///< median of CornerFit::sigma_px
  /// The top left square is white: a ChArUco board of OpenCV's layout before 4.6 with an even
  /// number of rows, or a checkerboard that looks the same upside down. nullopt: this picture does
  /// not tell.
  std::optional<bool> first_is_white = false;
};

/// How a corner is refined to sub-pixel accuracy.
enum class Refinement {
  kModel,  ///< fit_corner(), the default
  kOpencv  ///< cv::cornerSubPix in a window of 11 x 11, what most programs do
};

/// How thoroughly a checkerboard is searched for.
enum class Search {
  kThorough,  ///< also with equalised contrast, and enlarged: for pictures that should show it
  kQuick      ///< the picture as it is
};

/// Finds the board; nullopt where it is not seen. A checkerboard must be seen completely; ChArUco
/// boards and AprilGrids may be seen in part. The layout of a ChArUco board is found out; where it
/// is not told (BoardView::first_is_white), today's is taken, and the corners may be those of the
/// next column. Corners that cannot be refined are left out. The order of a checkerboard's corners
/// is the same from every side if one of columns and rows is odd and the other even (the square
/// between corners 0 and 1 is dark); else it depends on the picture. Thread-safe. Errors: kUsage
/// for an unknown dictionary.
Result<std::optional<BoardView>> detect_board(ImageView<const std::uint8_t> image,
                                              const BoardSpec& board,
                                              Refinement refinement = Refinement::kModel,
                                              Search search = Search::kThorough);

/// Finds the corners of `known` again in another picture, in which the board lies within a quarter
/// of a square of the same place, and refines them anew. Corners that are not found are left out.
/// Thread-safe.
BoardView find_again(ImageView<const std::uint8_t> image, const BoardSpec& board,
                     const BoardView& known);

/// Converts a colour picture to grey: Rec. 709 weights on the encoded values.
Image<std::uint8_t> gray_of(ImageView<const Rgb8> image);
/// Reduces a 16-bit picture to 8 bits, stretched so that 0.5 % of the pixels are black and 0.5 %
/// white.
Image<std::uint8_t> gray_of(ImageView<const std::uint16_t> image);

}  // namespace mixrig::calibration
