// SPDX-License-Identifier: Apache-2.0
// From the pictures of a view set to a first model.
#include "host/calibrate/rig/rig_start.h"

#include <algorithm>
#include <cmath>

#include "hal/base/order_statistics.h"
#include "host/calibrate/rig/mounting.h"
#include "host/calibrate/rig/rig_lens.h"

namespace mixrig::calibration {
namespace {

constexpr int kLeastStartViews = 5;
constexpr double kBadStartView = 8, kTypical_px = 0.1;

Error data_error(const std::string& what) { return {ErrorCode::kData, what}; }

/// Rotation vectors of a camera's views must differ, or lens and poses cannot be separated.
double spread_rad(const ViewSet& set, const RigModel& single, const std::vector<int>& views) {
  double widest = 0;
  for (const int a : views)
    for (const int b : views)
      widest = std::max(
          widest, angle_between(set, single.target_from_board[a], single.target_from_board[b]));
  return widest;
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

}  // namespace

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
    if (spread_rad(data.set, *single, views) < 0.15)
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
    MIXRIG_ASSIGN(model.cameras[c].camera_from_target,
                  find_mounting(data, model, placed, c, singles[c]));
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
