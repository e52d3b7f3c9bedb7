// SPDX-License-Identifier: Apache-2.0
// Pictures of a view set, and the board's corners in them.
#include "host/calibrate/rig/rig_data.h"

#include <algorithm>
#include <mutex>

#include <opencv2/aruco.hpp>

#include "host/calibrate/board/detect_board.h"

namespace mixrig::calibration {
namespace {

constexpr int kLeastStartCorners = 8;

std::optional<int> dictionary_of(const std::string& name) {
  if (name == "4X4_50") return cv::aruco::DICT_4X4_50;
  if (name == "4X4_100") return cv::aruco::DICT_4X4_100;
  if (name == "4X4_250") return cv::aruco::DICT_4X4_250;
  if (name == "5X5_50") return cv::aruco::DICT_5X5_50;
  if (name == "5X5_100") return cv::aruco::DICT_5X5_100;
  if (name == "5X5_250") return cv::aruco::DICT_5X5_250;
  if (name == "6X6_250") return cv::aruco::DICT_6X6_250;
  return std::nullopt;
}

/// The first error of several threads.
class FirstError {
 public:
  void keep(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = error;
  }
  Result<void> result() const { return error_ ? Result<void>(*error_) : Result<void>(); }

 private:
  std::mutex mutex_;
  std::optional<Error> error_;
};

/// All pictures, before the board is looked for in any: a wrong one is named at once.
Result<void> load_pictures(RigData& data, Crew& crew) {
  data.pictures.resize(static_cast<std::size_t>(data.set.views));
  FirstError error;
  crew.rows(data.set.views, 1, [&](int begin, int end) {
    for (int view = begin; view < end; ++view)
      for (const ViewCamera& camera : data.set.cameras) {
        auto pictures = load_view(data.set, camera, view + 1);
        if (!pictures) return error.keep(pictures.error());
        data.pictures[view].push_back(std::move(*pictures));
      }
  });
  return error.result();
}

/// Image circles of the fisheyes, in all their pictures.
void find_circles(RigData& data) {
  for (std::size_t c = 0; c < data.set.cameras.size(); ++c) {
    data.circles.emplace_back();
    if (data.set.cameras[c].lens != geometry::LensKind::kFisheye) continue;
    BrightestPicture brightest;
    for (const auto& pictures : data.pictures) brightest.add(pictures[c].gray.view());
    data.circles.back() = find_image_circle(brightest.image());
  }
}

/// What each picture tells of the first square's colour, by view, then camera.
using ToldColors = std::vector<std::vector<std::optional<bool>>>;

/// Takes the colour of the first square that most pictures tell. With an odd number of columns the
/// others fit both layouts: in the older one their corners are those of the column before.
void settle_first_square(RigData& data, const ToldColors& told) {
  int white = 0, black = 0;
  for (const auto& view : told)
    for (const std::optional<bool>& color : view)
      (color.value_or(false) ? white : black) += color ? 1 : 0;
  data.print.first_is_white = white > black;
  for (std::size_t view = 0; view < told.size() && data.print.first_is_white; ++view)
    for (std::size_t c = 0; c < told[view].size(); ++c) {
      if (told[view][c]) continue;
      std::vector<SeenCorner>& corners = data.corners[view][c];
      for (SeenCorner& corner : corners) corner.uv.x() -= 1;
      std::erase_if(corners, [](const SeenCorner& corner) { return corner.uv.x() < 1; });
    }
}

Result<void> find_corners(RigData& data, Crew& crew,
                          const std::function<void(int, int)>& progress) {
  const BoardSpec spec = board_of(data.set);
  const int inner = data.set.columns - 1;
  ToldColors told(data.corners.size(), std::vector<std::optional<bool>>(data.set.cameras.size()));
  FirstError error;
  std::mutex mutex;
  int done = 0;
  crew.rows(data.set.views, 1, [&](int begin, int end) {
    for (int view = begin; view < end; ++view) {
      for (std::size_t c = 0; c < data.set.cameras.size(); ++c) {
        const auto board = detect_board(data.pictures[view][c].gray, spec);
        if (!board) return error.keep(board.error());
        if (!*board) continue;
        const BoardView& seen = **board;
        told[view][c] = seen.first_is_white;
        auto& corners = data.corners[view][c];
        for (std::size_t k = 0; k < seen.ids.size(); ++k)
          if (!data.circles[c] || data.circles[c]->contains(seen.px[k]))
            corners.push_back({{seen.ids[k] % inner + 1.0, seen.ids[k] / inner + 1.0}, seen.px[k]});
        if (static_cast<int>(corners.size()) < kLeastStartCorners) corners.clear();
        const std::lock_guard lock(mutex);
        data.blur_px = std::max(data.blur_px, seen.blur_px);
      }
      const std::lock_guard lock(mutex);
      progress(++done, data.set.views);
    }
  });
  MIXRIG_TRY(error.result());
  settle_first_square(data, told);
  return {};
}

}  // namespace

BoardSpec board_of(const ViewSet& set) {
  BoardSpec spec;
  const bool charuco = set.board_kind == "charuco";
  spec.kind = charuco ? BoardKind::kCharuco : BoardKind::kCheckerboard;
  spec.columns = set.columns - (charuco ? 0 : 1), spec.rows = set.rows - (charuco ? 0 : 1);
  spec.square_m = set.square_m, spec.marker_m = set.marker_m;
  spec.dictionary = set.dictionary;
  return spec;
}

Result<BoardPrint> print_of(const ViewSet& set) {
  BoardPrint print;
  print.columns = set.columns, print.rows = set.rows;
  if (set.board_kind != "charuco") return print;
  const auto id = dictionary_of(set.dictionary);
  if (!id)
    return Error{ErrorCode::kUsage, (set.folder / "views.toml").string() + ": dictionary \"" +
                                        set.dictionary +
                                        "\" is not known: use 4X4_50, 5X5_250, 6X6_250, ..."};
  const auto dictionary = cv::aruco::getPredefinedDictionary(*id);
  const int bits = dictionary->markerSize, cells = bits + 2;
  print.marker = set.marker_m / set.square_m;
  print.marker_cells = cells;
  const int markers = std::min(set.columns * set.rows / 2, dictionary->bytesList.rows);
  for (int m = 0; m < markers; ++m) {
    const cv::Mat inner =
        cv::aruco::Dictionary::getBitsFromByteList(dictionary->bytesList.rowRange(m, m + 1), bits);
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) {
        const bool border = i == 0 || j == 0 || i == cells - 1 || j == cells - 1;
        print.ink.push_back(border || inner.at<std::uint8_t>(j - 1, i - 1) == 0 ? 1 : 0);
      }
  }
  return print;
}

Result<RigData> load_rig_data(const ViewSet& set, const std::vector<std::string>& wanted,
                              Crew& crew, const std::function<void(int, int)>& progress) {
  RigData data;
  data.set = set;
  if (!wanted.empty()) {
    data.set.cameras.clear();
    for (const std::string& name : wanted) {
      MIXRIG_ASSIGN(const int index, find_camera(set, name));
      data.set.cameras.push_back(set.cameras[static_cast<std::size_t>(index)]);
    }
  }
  MIXRIG_ASSIGN(data.print, print_of(set));
  const std::size_t cameras = data.set.cameras.size();
  data.corners.assign(static_cast<std::size_t>(set.views),
                      std::vector<std::vector<SeenCorner>>(cameras));
  data.misfound.resize(cameras);
  MIXRIG_TRY(load_pictures(data, crew));
  find_circles(data);
  MIXRIG_TRY(find_corners(data, crew, progress));
  return data;
}

std::optional<ImageCircle> circle_of(const RigData& data, std::size_t camera) {
  return camera < data.circles.size() ? data.circles[camera] : std::nullopt;
}

std::vector<int> seen_by(const RigData& data, std::size_t camera) {
  std::vector<int> views;
  for (std::size_t v = 0; v < data.corners.size(); ++v)
    if (!data.corners[v][camera].empty()) views.push_back(static_cast<int>(v));
  return views;
}

}  // namespace mixrig::calibration
