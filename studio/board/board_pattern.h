// SPDX-License-Identifier: Apache-2.0
// The studio's calibration board: checkerboard or ChArUco, flat or bent.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "hal/base/result.h"
#include "studio/stage/mesh.h"

namespace mixrig::studio {

enum class BoardKind { kCheckerboard, kCharuco };
std::string_view name(BoardKind kind);
/// Parses the name of a kind of board. Errors: kUsage; the line lists the names that exist.
Result<BoardKind> parse_board(std::string_view text);

/// Dimensions of a board. Square (0, 0) is black. Board axes: u to the right, v down, w into the
/// board; the origin is the outer corner of square (0, 0). ChArUco: the white squares hold markers
/// 0, 1, ... of the dictionary 4x4_50, row by row as in OpenCV 4.6.
struct BoardPlan {
  BoardKind kind = BoardKind::kCheckerboard;
  int columns = 10, rows = 7;  ///< 3..40
  double square_m = 0.07;
  double marker_m = 0.0525;  ///< ChArUco: side of a marker including its black border
  double bend_m = 0;  ///< the middle column is this much nearer to the camera; negative: farther
  double width_m() const { return columns * square_m; }
  double height_m() const { return rows * square_m; }
  double margin_m() const { return 0.6 * square_m; }  ///< white paper around the squares
};

/// w of the bent board at u.
double board_w_m(const BoardPlan& plan, double u_m);

/// The markers of the dictionary: bits row by row, 1 = white, bit 15 first.
std::span<const std::uint16_t> marker_bits();

/// Black and white of the board.
class BoardPattern {
 public:
  explicit BoardPattern(const BoardPlan& plan) : plan_(plan) {}
  bool white(float u_m, float v_m) const;
  /// Share of white in a box around (u, v); exact if at most one edge crosses it in each direction.
  float white_share(float u_m, float v_m, float half_u_m, float half_v_m) const;
  /// True if no edge crosses the window around (u, v) with these half sides: it has one colour.
  bool is_one_color(float u_m, float v_m, float half_u_m, float half_v_m) const;

 private:
  bool marker_white(int column, int row, float u, float v) const;
  /// Position of the edge of a square or marker cell inside an interval, if there is one.
  std::optional<float> crossing(float at_m, float half_m, int squares) const;
  BoardPlan plan_;
};

/// The board's front surface in board axes; uv are board coordinates in metres.
Mesh build_board(const BoardPlan& plan);

}  // namespace mixrig::studio
