// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/find_charuco.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>

namespace mixrig::calibration {
namespace {

using Quad = std::vector<cv::Point2f>;

bool has_two_layouts(const BoardSpec& board) { return board.rows % 2 == 0; }

cv::Point2f middle_of(const Quad& q) { return (q[0] + q[1] + q[2] + q[3]) / 4; }

/// Step from one marker to another in squares along the board's columns and rows, by the sides of
/// both: exact without perspective, good enough to neighbours.
cv::Point2f step_between(const Quad& a, const Quad& b, double squares_per_marker) {
  const auto mean_side = [&](int from, int to, int from2, int to2) {
    return (a[to] - a[from] + a[to2] - a[from2] + b[to] - b[from] + b[to2] - b[from2]) / 4;
  };
  const cv::Point2f right = mean_side(0, 1, 3, 2), down = mean_side(0, 3, 1, 2);
  const cv::Point2f way = middle_of(b) - middle_of(a);
  const double area = right.cross(down);
  return {static_cast<float>(way.cross(down) / area / squares_per_marker),
          static_cast<float>(right.cross(way) / area / squares_per_marker)};
}

/// Pairs of found markers that touch at a corner in one layout, and those of them that lie
/// otherwise in the picture.
struct Votes {
  int pairs = 0, against = 0;
};

Votes votes_for(const FoundMarkers& found, const BoardSpec& board, bool older) {
  constexpr float kNear = 0.5F;  // squares
  const double squares_per_marker = board.square_m / board.marker_m;
  const int markers = board.columns * board.rows / 2;
  Votes votes;
  for (std::size_t i = 0; i < found.ids.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (found.ids[i] >= markers || found.ids[j] >= markers) continue;
      const cv::Point said =
          square_of(found.ids[j], board, older) - square_of(found.ids[i], board, older);
      if (std::abs(said.x) != 1 || std::abs(said.y) != 1) continue;
      const cv::Point2f seen = step_between(found.px[i], found.px[j], squares_per_marker);
      ++votes.pairs;
      if (!(std::abs(seen.x - static_cast<float>(said.x)) < kNear &&
            std::abs(seen.y - static_cast<float>(said.y)) < kNear))
        ++votes.against;
    }
  return votes;
}

/// Moves the markers of OpenCV's board to the squares of the older layout, and finds the two at
/// each inner corner anew.
void make_older(cv::aruco::CharucoBoard& board, const BoardSpec& spec) {
  const auto side = static_cast<float>(spec.square_m);
  for (std::size_t m = 0; m < board.ids.size(); ++m) {
    const cv::Point moved =
        square_of(board.ids[m], spec, true) - square_of(board.ids[m], spec, false);
    for (cv::Point3f& corner : board.objPoints[m])
      corner +=
          cv::Point3f(side * static_cast<float>(moved.x), side * static_cast<float>(moved.y), 0);
  }
  constexpr double kTouching = 0.75;  // squares from a corner to a marker's middle: 0.71 or 1.58
  for (std::size_t c = 0; c < board.chessboardCorners.size(); ++c) {
    const cv::Point3f& corner = board.chessboardCorners[c];
    const auto away = [&](const cv::Point3f& p) { return cv::norm(p - corner); };
    board.nearestMarkerIdx[c].clear();
    board.nearestMarkerCorners[c].clear();
    for (std::size_t m = 0; m < board.objPoints.size(); ++m) {
      const std::vector<cv::Point3f>& quad = board.objPoints[m];
      if (away((quad[0] + quad[2]) / 2) > kTouching * spec.square_m) continue;
      const auto nearest =
          std::min_element(quad.begin(), quad.end(),
                           [&](const auto& a, const auto& b) { return away(a) < away(b); });
      board.nearestMarkerIdx[c].push_back(static_cast<int>(m));
      board.nearestMarkerCorners[c].push_back(static_cast<int>(nearest - quad.begin()));
    }
  }
}

}  // namespace

cv::Point square_of(int marker, const BoardSpec& board, bool older) {
  const int columns = board.columns;
  if (columns % 2 == 1) {  // every second square in reading order
    const int at = 2 * marker + (older ? 0 : 1);
    return {at % columns, at / columns};
  }
  const int row = marker / (columns / 2);
  const bool starts_white = (row % 2 == 0) == older;
  return {2 * (marker % (columns / 2)) + (starts_white ? 0 : 1), row};
}

std::optional<bool> is_older_layout(const FoundMarkers& found, const BoardSpec& board) {
  if (!has_two_layouts(board)) return false;
  constexpr int kLeast = 3;          // one marker that was read wrongly contradicts in two pairs
  constexpr int kPairsPerError = 8;  // of the true layout
  const Votes today = votes_for(found, board, false), older = votes_for(found, board, true);
  const bool less = older.against < today.against;
  const Votes &better = less ? older : today, &worse = less ? today : older;
  if (worse.against - better.against < kLeast || better.against * kPairsPerError > better.pairs)
    return std::nullopt;
  return less;
}

std::optional<BoardView> find_charuco(const cv::Mat& image, const BoardSpec& board,
                                      int dictionary) {
  const auto known = cv::aruco::getPredefinedDictionary(dictionary);
  const auto charuco =
      cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.square_m),
                                      static_cast<float>(board.marker_m), known);
  FoundMarkers found;
  cv::aruco::detectMarkers(image, known, found.px, found.ids);
  if (found.ids.empty()) return std::nullopt;
  const auto older = is_older_layout(found, board);
  if (older.value_or(false)) make_older(*charuco, board);
  std::vector<cv::Point2f> corners;
  BoardView view;
  cv::aruco::interpolateCornersCharuco(found.px, found.ids, image, charuco, corners, view.ids);
  if (view.ids.empty()) return std::nullopt;
  for (const auto& p : corners) view.px.emplace_back(p.x, p.y);
  view.first_is_white = older;
  return view;
}

}  // namespace mixrig::calibration
