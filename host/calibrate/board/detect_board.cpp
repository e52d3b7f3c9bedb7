// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/detect_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "host/calibrate/board/find_charuco.h"
#include "host/calibrate/board/refine_corners.h"

namespace mixrig::calibration {
namespace {

using Eigen::Vector2d;
using Points = std::vector<cv::Point2f>;

cv::Mat as_mat(ImageView<const std::uint8_t> image) {
  return {image.size.height, image.size.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
          static_cast<std::size_t>(image.stride)};
}

/// A corner grid, by several finders, because each misses some boards; the fast ones first
/// (CALIB_CB_ACCURACY takes four times as long, and refine_corners() is more accurate). Pixels are
/// those of `image`.
std::optional<Points> find_checkerboard(const cv::Mat& image, cv::Size pattern, Search search) {
  constexpr int kSector = cv::CALIB_CB_NORMALIZE_IMAGE;
  constexpr int kClassic = cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_ADAPTIVE_THRESH;
  constexpr int kMaxEnlarged_px = 1000;  // a larger picture shows larger squares
  Points corners;
  if (cv::findChessboardCornersSB(image, pattern, corners, kSector)) return corners;
  if (cv::findChessboardCorners(image, pattern, corners, kClassic | cv::CALIB_CB_FAST_CHECK))
    return corners;
  if (search == Search::kQuick) return std::nullopt;
  cv::Mat even;
  cv::createCLAHE(4.0, {8, 8})->apply(image, even);
  if (cv::findChessboardCornersSB(even, pattern, corners, kSector)) return corners;
  if (cv::findChessboardCorners(even, pattern, corners, kClassic)) return corners;
  if (std::max(image.cols, image.rows) > kMaxEnlarged_px) return std::nullopt;
  cv::Mat twice;
  cv::resize(even, twice, {}, 2, 2, cv::INTER_CUBIC);
  if (!cv::findChessboardCornersSB(twice, pattern, corners, kSector)) return std::nullopt;
  // resize() keeps the picture's outer edges in place: pixel centres move by half a pixel.
  for (auto& p : corners) p = {(p.x + 0.5F) / 2 - 0.5F, (p.y + 0.5F) / 2 - 0.5F};
  return corners;
}

/// Mean grey of a small square about a point.
double brightness(const cv::Mat& image, const cv::Point2f& at) {
  constexpr int kHalf = 1;
  const cv::Rect whole(0, 0, image.cols, image.rows);
  const cv::Rect box(static_cast<int>(std::lround(at.x)) - kHalf,
                     static_cast<int>(std::lround(at.y)) - kHalf, 2 * kHalf + 1, 2 * kHalf + 1);
  return (box & whole).empty() ? 0 : cv::mean(image(box & whole))[0];
}

/// Corners of a checkerboard in rows.
struct Grid {
  int columns = 0, rows = 0;
  Points px;

  const cv::Point2f& at(int c, int r) const {
    return px[static_cast<std::size_t>(r * columns + c)];
  }
};

/// True where the field at corners 0 and 1 of both directions, and every second one, is lighter.
bool is_first_field_white(const cv::Mat& image, const Grid& grid) {
  double sum[2] = {0, 0};
  int count[2] = {0, 0};
  for (int r = 0; r + 1 < grid.rows; ++r)
    for (int c = 0; c + 1 < grid.columns; ++c) {
      const cv::Point2f middle =
          (grid.at(c, r) + grid.at(c + 1, r) + grid.at(c, r + 1) + grid.at(c + 1, r + 1)) / 4;
      sum[(c + r) % 2] += brightness(image, middle);
      ++count[(c + r) % 2];
    }
  return sum[0] * count[1] > sum[1] * count[0];
}

/// Turns a square grid by a quarter.
void turn_by_a_quarter(Grid& grid) {
  const Grid old = grid;
  for (int r = 0; r < grid.rows; ++r)
    for (int c = 0; c < grid.columns; ++c)
      grid.px[static_cast<std::size_t>(r * grid.columns + c)] = old.at(r, grid.columns - 1 - c);
}

/// Turns the grid so that columns and rows are right-handed (x, y down), and so that the first
/// field is dark where a turn can make it so; where both ends look alike, corner 0 is the upper or
/// left one. Returns whether the first field is white nevertheless.
bool make_order_canonical(const cv::Mat& image, Grid& grid) {
  Points& p = grid.px;
  const auto across = grid.at(grid.columns - 1, 0) - grid.at(0, 0);
  const auto down = grid.at(0, grid.rows - 1) - grid.at(0, 0);
  if (across.cross(down) < 0)
    for (int r = 0; r < grid.rows; ++r)
      std::reverse(p.begin() + r * grid.columns, p.begin() + (r + 1) * grid.columns);
  bool white = is_first_field_white(image, grid);
  if ((grid.columns + grid.rows) % 2 == 1) {
    if (white) std::reverse(p.begin(), p.end());
    return false;
  }
  if (white && grid.columns == grid.rows && grid.columns % 2 == 1) {
    turn_by_a_quarter(grid);
    white = false;
  }
  if (p.front().y + p.front().x > p.back().y + p.back().x) std::reverse(p.begin(), p.end());
  return white;
}

BoardView view_of(const std::vector<int>& ids, const Points& px) {
  BoardView view;
  view.ids = ids;
  for (const auto& p : px) view.px.emplace_back(p.x, p.y);
  return view;
}

std::optional<BoardView> rough_checkerboard(const cv::Mat& image, const BoardSpec& board,
                                            Search search) {
  auto corners = find_checkerboard(image, {board.columns, board.rows}, search);
  if (!corners) return std::nullopt;
  Grid grid{board.columns, board.rows, std::move(*corners)};
  const bool white = make_order_canonical(image, grid);
  std::vector<int> ids(grid.px.size());
  std::iota(ids.begin(), ids.end(), 0);
  BoardView view = view_of(ids, grid.px);
  view.first_is_white = white;
  return view;
}

/// OpenCV's first corner of a tag depends on the orientation of the dictionary: the one of four
/// that fits the grid best is taken.
std::optional<BoardView> order_tags(const std::vector<Points>& tags, const std::vector<int>& ids,
                                    const BoardSpec& board) {
  const auto points_m = board_points_m(board);
  std::optional<BoardView> best;
  double least = 0;
  for (std::size_t turn = 0; turn < 4; ++turn) {
    BoardView view;
    Points from, to;
    for (std::size_t t = 0; t < tags.size(); ++t)
      for (std::size_t c = 0; c < 4; ++c) {
        // OpenCV goes clockwise in the picture, Kalibr counter-clockwise.
        const cv::Point2f& px = tags[t][(turn + 4 - c) % 4];
        const int id = ids[t] * 4 + static_cast<int>(c);
        const auto& m = points_m[static_cast<std::size_t>(id)];
        view.ids.push_back(id);
        view.px.emplace_back(px.x, px.y);
        from.emplace_back(static_cast<float>(m.x()), static_cast<float>(m.y()));
        to.push_back(px);
      }
    const cv::Mat h = cv::findHomography(from, to);
    if (h.empty()) continue;
    Points back;
    cv::perspectiveTransform(from, back, h);
    const double error = cv::norm(back, to);
    if (best && error >= least) continue;
    best = view;
    least = error;
  }
  return best;
}

std::optional<BoardView> rough_aprilgrid(const cv::Mat& image, const BoardSpec& board) {
  const auto known = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11);
  std::vector<Points> found;
  std::vector<int> found_ids;
  for (const int border : {2, 1}) {  // Kalibr prints 2, others 1
    const auto parameters = cv::aruco::DetectorParameters::create();
    parameters->markerBorderBits = border;
    std::vector<Points> tags, kept;
    std::vector<int> ids, kept_ids;
    cv::aruco::detectMarkers(image, known, tags, ids, parameters);
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (const int id = ids[i] - board.first_tag; id >= 0 && id < board.columns * board.rows) {
        kept.push_back(tags[i]);
        kept_ids.push_back(id);
      }
    if (kept.size() > found.size()) found = kept, found_ids = kept_ids;
  }
  constexpr std::size_t kFewest = 2;  // the orientation of a single tag is ambiguous
  if (found.size() < kFewest) return std::nullopt;
  return order_tags(found, found_ids, board);
}

/// Index of OpenCV's predefined dictionary.
std::optional<int> dictionary_of(const std::string& name) {
  constexpr std::array<const char*, 21> kNames{
      "4X4_50",        "4X4_100",        "4X4_250",       "4X4_1000",      "5X5_50",
      "5X5_100",       "5X5_250",        "5X5_1000",      "6X6_50",        "6X6_100",
      "6X6_250",       "6X6_1000",       "7X7_50",        "7X7_100",       "7X7_250",
      "7X7_1000",      "ARUCO_ORIGINAL", "APRILTAG_16h5", "APRILTAG_25h9", "APRILTAG_36h10",
      "APRILTAG_36h11"};
  const auto at = std::find(kNames.begin(), kNames.end(), name);
  if (at == kNames.end()) return std::nullopt;
  return static_cast<int>(at - kNames.begin());
}

BoardView refine_as_opencv(const cv::Mat& image, BoardView view) {
  Points px;
  for (const Vector2d& p : view.px)
    px.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  cv::cornerSubPix(image, px, {5, 5}, {-1, -1},
                   {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 1e-3});
  for (std::size_t i = 0; i < px.size(); ++i) view.px[i] = {px[i].x, px[i].y};
  return view;
}

void sort_by_id(BoardView& view) {
  std::vector<std::size_t> order(view.ids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return view.ids[a] < view.ids[b]; });
  BoardView sorted = view;
  for (std::size_t i = 0; i < order.size(); ++i) {
    sorted.ids[i] = view.ids[order[i]];
    sorted.px[i] = view.px[order[i]];
  }
  view = std::move(sorted);
}

}  // namespace

Result<std::optional<BoardView>> detect_board(ImageView<const std::uint8_t> image,
                                              const BoardSpec& board, Refinement refinement,
                                              Search search) {
  if (image.empty()) return std::optional<BoardView>();
  std::optional<BoardView> rough;
  try {
    const cv::Mat mat = as_mat(image);
    if (board.kind == BoardKind::kCharuco) {
      const auto dictionary = dictionary_of(board.dictionary);
      if (!dictionary)
        return Error{ErrorCode::kUsage, "board: there is no marker dictionary '" +
                                            board.dictionary +
                                            "': use OpenCV's name without DICT_, as 5X5_250"};
      rough = find_charuco(mat, board, *dictionary);
    } else {
      rough = board.kind == BoardKind::kAprilgrid ? rough_aprilgrid(mat, board)
                                                  : rough_checkerboard(mat, board, search);
    }
    if (rough && refinement == Refinement::kOpencv) {
      rough = refine_as_opencv(mat, *rough);
      sort_by_id(*rough);
      return rough;
    }
  } catch (const cv::Exception& error) {
    return Error{ErrorCode::kData, std::string("the board finder failed: ") + error.err};
  }
  if (!rough) return std::optional<BoardView>();
  BoardView view = refine_corners(image, board, *rough);
  view.first_is_white = rough->first_is_white;
  sort_by_id(view);
  constexpr std::size_t kFewest = 6;
  return view.ids.size() < kFewest ? std::optional<BoardView>() : std::optional(std::move(view));
}

BoardView find_again(ImageView<const std::uint8_t> image, const BoardSpec& board,
                     const BoardView& known) {
  return refine_corners(image, board, known);
}

Image<std::uint8_t> gray_of(ImageView<const Rgb8> image) {
  Image<std::uint8_t> gray(image.size);
  for (int y = 0; y < image.size.height; ++y)
    std::transform(image.row(y), image.row(y) + image.size.width, gray.row(y), [](const Rgb8& p) {
      return static_cast<std::uint8_t>((54 * p.r + 183 * p.g + 19 * p.b + 128) / 256);
    });
  return gray;
}

Image<std::uint8_t> gray_of(ImageView<const std::uint16_t> image) {
  std::vector<std::uint32_t> counts(65536, 0);
  for (int y = 0; y < image.size.height; ++y)
    for (int x = 0; x < image.size.width; ++x) ++counts[image.at(x, y)];
  const auto rank = [&](double share) {
    double left = share * static_cast<double>(image.size.area());
    std::size_t value = 0;
    while (value < 65535 && (left -= counts[value]) > 0) ++value;
    return static_cast<int>(value);
  };
  const int black = rank(0.005), white = std::max(rank(0.995), black + 1);
  Image<std::uint8_t> gray(image.size);
  for (int y = 0; y < image.size.height; ++y)
    std::transform(
        image.row(y), image.row(y) + image.size.width, gray.row(y), [&](std::uint16_t v) {
          return static_cast<std::uint8_t>(std::clamp((v - black) * 255 / (white - black), 0, 255));
        });
  return gray;
}

}  // namespace mixrig::calibration
