// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/suggest_board.h"

#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>

namespace mixrig::calibration {
namespace {

/// Beyond this no lens explains a view's misfit to a homography, as a share of the view's extent.
constexpr double kWrongShare = 0.03;

double extent_px(const BoardView& view) {
  Eigen::Vector2d low = view.px.front(), high = low;
  for (const auto& p : view.px) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

std::vector<BoardSpec> mixed_up_with(const BoardSpec& stated) {
  std::vector<BoardSpec> boards;
  const auto add = [&](int columns, int rows) {
    BoardSpec board = stated;
    board.columns = columns;
    board.rows = rows;
    if (std::min(columns, rows) >= 3 && !(board == stated)) boards.push_back(board);
  };
  const int c = stated.columns, r = stated.rows;
  if (stated.kind == BoardKind::kCheckerboard) {
    for (const auto& [dc, dr] : {std::pair(-1, -1), {1, 1}, {-1, 0}, {0, -1}, {1, 0}, {0, 1}})
      add(c + dc, r + dr);
    return boards;
  }
  add(r, c);
  for (int d = 1; d <= 3; ++d) {
    add(c + d, r);
    add(c - d, r);
  }
  return boards;
}

}  // namespace

double homography_misfit_px(const BoardView& view, const BoardSpec& board) {
  const auto points_m = board_points_m(board);
  std::vector<cv::Point2d> from, to;
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const auto& p = points_m[static_cast<std::size_t>(view.ids[i])];
    from.emplace_back(p.x(), p.y());
    to.emplace_back(view.px[i].x(), view.px[i].y());
  }
  const cv::Mat h = cv::findHomography(from, to, cv::LMEDS);
  if (h.empty()) return extent_px(view);
  std::vector<cv::Point2d> back;
  cv::perspectiveTransform(from, back, h);
  std::vector<double> squares;
  for (std::size_t i = 0; i < to.size(); ++i)
    squares.push_back((back[i] - to[i]).dot(back[i] - to[i]));
  std::sort(squares.begin(), squares.end());
  squares.resize(std::max<std::size_t>(squares.size() * 3 / 4, 1));
  double sum = 0;
  for (const double s : squares) sum += s;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

std::optional<BoardSpec> suggest_board(ImageView<const std::uint8_t> image,
                                       const BoardSpec& stated) {
  if (stated.kind == BoardKind::kAprilgrid) return std::nullopt;
  std::optional<BoardSpec> best;
  std::size_t most = 0;  // wrong layouts agree with some markers by chance, the right one with most
  for (const BoardSpec& board : mixed_up_with(stated)) {
    const auto view = detect_board(image, board, Refinement::kModel, Search::kQuick);
    if (!view || !*view || (*view)->ids.size() <= most) continue;
    if (homography_misfit_px(**view, board) > kWrongShare * extent_px(**view)) continue;
    best = board;
    most = (*view)->ids.size();
    if (stated.kind == BoardKind::kCheckerboard) break;  // found completely: no other is possible
  }
  return best;
}

}  // namespace mixrig::calibration
