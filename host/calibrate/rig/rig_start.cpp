// SPDX-License-Identifier: Apache-2.0
// From the pictures of a view set to a first model.
#include "host/calibrate/rig/rig_start.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>

#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>

#include "hal/base/order_statistics.h"
#include "host/calibrate/board/detect_board.h"
#include "host/calibrate/rig/rig_lens.h"

namespace mixrig::calibration {
namespace {

constexpr int kLeastStartViews = 5, kLeastStartCorners = 8;
constexpr double kBadStartView = 8, kTypical_px = 0.1;

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

BoardSpec spec_of(const ViewSet& set) {
  BoardSpec spec;
  const bool charuco = set.board_kind == "charuco";
  spec.kind = charuco ? BoardKind::kCharuco : BoardKind::kCheckerboard;
  spec.columns = set.columns - (charuco ? 0 : 1), spec.rows = set.rows - (charuco ? 0 : 1);
  spec.square_m = set.square_m, spec.marker_m = set.marker_m;
  spec.dictionary = set.dictionary;
  return spec;
}

Error data_error(const std::string& what) { return {ErrorCode::kData, what}; }

/// Rotation vectors of a camera's views must differ, or lens and poses cannot be separated.
double spread_rad(const RigModel& single, const std::vector<int>& views) {
  double widest = 0;
  for (const int a : views)
    for (const int b : views)
      widest = std::max(widest, single.target_from_board[a].rotation.angularDistance(
                                    single.target_from_board[b].rotation));
  return widest;
}

/// The pose with the least sum of distances to the others.
geometry::Pose middle_of(const std::vector<geometry::Pose>& poses) {
  std::size_t best = 0;
  double least = 1e300;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    double sum = 0;
    for (const geometry::Pose& other : poses)
      sum += (poses[i].translation_m - other.translation_m).norm() +
             poses[i].rotation.angularDistance(other.rotation);
    if (sum < least) least = sum, best = i;
  }
  return poses[best];
}

/// Removes a camera's views that contradict its mounting: there the finder shifted the board by a
/// square, which is not visible in that camera alone. The target camera's poses are in `model`.
void drop_contradicting(RigData& data, const RigModel& model, std::size_t camera) {
  std::vector<double> misses;
  std::vector<int> shared;
  for (const int view : seen_by(data, camera)) {
    if (data.corners[view][0].empty()) continue;
    shared.push_back(view);
    misses.push_back(corner_error(data, model, camera, {view}).rms_px);
  }
  const double typical = std::max(upper_median(misses), kTypical_px);
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (misses[i] < kBadStartView * typical) continue;
    std::vector<SeenCorner>& corners = data.corners[shared[i]][camera];
    data.misfound[camera].views.push_back(shared[i]);
    data.misfound[camera].corners += static_cast<int>(corners.size());
    corners.clear();
  }
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

Result<void> find_corners(RigData& data, Crew& crew,
                          const std::function<void(int, int)>& progress) {
  const BoardSpec spec = spec_of(data.set);
  const int inner = data.set.columns - 1;
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
  return error.result();
}

}  // namespace

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

bool board_pose(const RigData& data, const RigModel& model, std::size_t camera, int view,
                geometry::Pose& camera_from_board) {
  return pose_of_corners(model.cameras[camera], model.square_m, data.corners[view][camera],
                         camera_from_board);
}

CornerError corner_error(const RigData& data, const RigModel& model, std::size_t camera,
                         const std::vector<int>& views) {
  CornerError error;
  double squares = 0;
  const RigCamera& c = model.cameras[camera];
  for (const int view : views) {
    const auto& corners = data.corners[view][camera];
    if (corners.empty()) continue;
    ++error.views;
    const geometry::Pose pose = c.camera_from_target * model.target_from_board[view];
    for (const SeenCorner& corner : corners) {
      const auto point = board_point(model, data.print.columns, data.print.rows, corner.uv);
      const auto seen =
          geometry::project_with_jacobians(c.lens, c.parameters.data(), pose * point.p_m);
      if (!seen) continue;
      squares += (seen->px - corner.px).squaredNorm();
      ++error.corners;
    }
  }
  if (error.corners > 0) error.rms_px = std::sqrt(squares / error.corners);
  return error;
}

Result<RigModel> start_rig(RigData& data, Crew& crew) {
  RigModel model;
  model.square_m = data.set.square_m;
  model.target_from_board.resize(data.corners.size());
  std::vector<RigModel> singles;
  for (std::size_t c = 0; c < data.set.cameras.size(); ++c) {
    const ViewCamera& camera = data.set.cameras[c];
    std::vector<int> views = seen_by(data, c);
    const std::string who = "camera \"" + camera.name + "\"";
    if (static_cast<int>(views.size()) < kLeastStartViews)
      return data_error(who + " sees the board in " + std::to_string(views.size()) + " of " +
                        std::to_string(data.set.views) + " views, but " +
                        std::to_string(kLeastStartViews) +
                        " are needed: check the board's squares in views.toml, light and "
                        "sharpness, and that the whole board is in the picture");
    auto single = solve_lens(data, c, crew);
    if (!single) return single.error();
    views = seen_by(data, c);
    if (spread_rad(*single, views) < 0.15)
      return data_error("all views of " + who +
                        " are alike: tilt the board by 20 to 40 degrees, to all sides");
    model.cameras.push_back(single->cameras[0]);
    singles.push_back(std::move(*single));
  }
  std::vector<bool> placed(data.corners.size(), false);
  for (const int view : seen_by(data, 0)) {
    model.target_from_board[view] = singles[0].target_from_board[view];
    placed[view] = true;
  }
  for (std::size_t c = 1; c < model.cameras.size(); ++c) {
    std::vector<geometry::Pose> mounting;
    const std::vector<int> views = seen_by(data, c);
    for (const int view : views)
      if (!data.corners[view][0].empty())
        mounting.push_back(singles[c].target_from_board[view] *
                           geometry::inverse(singles[0].target_from_board[view]));
    if (mounting.size() < 3)
      return data_error("cameras \"" + model.cameras[0].name + "\" and \"" + model.cameras[c].name +
                        "\" share " + std::to_string(mounting.size()) +
                        " views of the board, but 3 are needed: hold it where both see it");
    model.cameras[c].camera_from_target = middle_of(mounting);
    drop_contradicting(data, model, c);
    for (const int view : seen_by(data, c))
      if (!placed[view]) {
        model.target_from_board[view] = geometry::inverse(model.cameras[c].camera_from_target) *
                                        singles[c].target_from_board[view];
        placed[view] = true;
      }
  }
  return model;
}

}  // namespace mixrig::calibration
