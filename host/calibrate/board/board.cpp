// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/board.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace mixrig::calibration {
namespace {

constexpr const char* kForms =
    "use checkerboard:COLUMNSxROWS:SQUARE, charuco:COLUMNSxROWS:SQUARE:MARKER:DICTIONARY or "
    "aprilgrid:COLUMNSxROWS:TAG:GAP[:FIRST], lengths as 25mm";
constexpr int kTags = 587;  // of the dictionary 36h11

std::vector<std::string_view> split(std::string_view text, char by) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto at = text.find(by);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

/// A whole number from `least` to `most`.
std::optional<int> parse_count(std::string_view word, int least, int most) {
  int value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || end != word.data() + word.size() || value < least || value > most)
    return std::nullopt;
  return value;
}

/// "25mm", "2.5cm" or "0.025m", within 0.1 mm and 100 m.
std::optional<double> parse_length_m(std::string_view word) {
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc()) return std::nullopt;
  const std::string_view unit(end, static_cast<std::size_t>(word.data() + word.size() - end));
  const double scale = unit == "mm" ? 1e-3 : unit == "cm" ? 1e-2 : unit == "m" ? 1.0 : 0.0;
  const double metres = value * scale;
  return metres >= 1e-4 && metres <= 100 ? std::optional(metres) : std::nullopt;
}

std::string millimetres(double metres) { return fmt::format("{:.9g}mm", metres * 1e3); }

}  // namespace

Result<BoardSpec> parse_board(std::string_view text) {
  const auto bad = [&](const std::string& what) {
    return Error{ErrorCode::kUsage, "board '" + std::string(text) + "': " + what + ": " + kForms};
  };
  const auto parts = split(text, ':');
  BoardSpec board;
  std::size_t count = 3;
  if (parts[0] == "charuco")
    board.kind = BoardKind::kCharuco, count = 5;
  else if (parts[0] == "aprilgrid")
    board.kind = BoardKind::kAprilgrid, count = 4;
  else if (parts[0] != "checkerboard")
    return bad("not a kind of board");
  const bool has_first = board.kind == BoardKind::kAprilgrid && parts.size() == count + 1;
  if (parts.size() != count && !has_first)
    return bad("has " + std::to_string(parts.size()) + " parts");
  const auto sides = split(parts[1], 'x');
  const auto columns = parse_count(sides[0], 1, 100), rows = parse_count(sides.back(), 1, 100);
  if (sides.size() != 2 || !columns || !rows) return bad("the size must be as 9x6");
  board.columns = *columns;
  board.rows = *rows;
  const int least = board.kind == BoardKind::kAprilgrid ? 1 : 3;
  if (std::min(board.columns, board.rows) < least || board.columns * board.rows < 2)
    return bad("has too few columns or rows");
  const auto square = parse_length_m(parts[2]);
  if (!square) return bad("the side must be a length as 25mm");
  board.square_m = *square;
  if (count == 3) return board;
  const auto second = parse_length_m(parts[3]);
  if (!second) return bad("the second length must be as 18mm");
  if (board.kind == BoardKind::kAprilgrid) {
    board.gap_m = *second;
    const int most = kTags - board.columns * board.rows;
    const auto first = has_first ? parse_count(parts[4], 0, most) : std::min(most, 0);
    if (!first || *first < 0) return bad("its tags must be among the 587 of the dictionary 36h11");
    board.first_tag = *first;
    return board;
  }
  if (*second >= board.square_m) return bad("a marker must be smaller than its square");
  board.marker_m = *second;
  board.dictionary = std::string(parts[4]);
  return board;
}

std::string board_text(const BoardSpec& board) {
  const std::string rest =
      fmt::format(":{}x{}:{}", board.columns, board.rows, millimetres(board.square_m));
  switch (board.kind) {
    case BoardKind::kCharuco:
      return "charuco" + rest + ":" + millimetres(board.marker_m) + ":" + board.dictionary;
    case BoardKind::kAprilgrid:
      return "aprilgrid" + rest + ":" + millimetres(board.gap_m) +
             (board.first_tag > 0 ? ":" + std::to_string(board.first_tag) : "");
    default:
      return "checkerboard" + rest;
  }
}

std::vector<Eigen::Vector3d> board_points_m(const BoardSpec& board) {
  std::vector<Eigen::Vector3d> points;
  if (board.kind == BoardKind::kAprilgrid) {
    const double step = board.square_m + board.gap_m, side = board.square_m;
    for (int r = 0; r < board.rows; ++r)
      for (int c = 0; c < board.columns; ++c) {
        const double left = c * step, top = (board.rows - 1 - r) * step;
        points.insert(points.end(), {{left, top + side, 0},
                                     {left + side, top + side, 0},
                                     {left + side, top, 0},
                                     {left, top, 0}});
      }
    return points;
  }
  const int inner = board.kind == BoardKind::kCharuco ? 1 : 0;
  for (int r = 0; r < board.rows - inner; ++r)
    for (int c = 0; c < board.columns - inner; ++c)
      points.emplace_back(c * board.square_m, r * board.square_m, 0);
  return points;
}

double pitch_m(const BoardSpec& board) {
  return board.kind == BoardKind::kAprilgrid ? std::min(board.square_m, board.gap_m)
                                             : board.square_m;
}

double clear_radius_m(const BoardSpec& board) {
  switch (board.kind) {
    case BoardKind::kCharuco:  // the corner of the nearest marker
      return (board.square_m - board.marker_m) / std::sqrt(2.0);
    case BoardKind::kAprilgrid:  // the far corners of the square in the gap
      return board.gap_m;
    default:
      return board.square_m;
  }
}

}  // namespace mixrig::calibration
