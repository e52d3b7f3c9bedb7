// SPDX-License-Identifier: Apache-2.0
// From the pictures of a view set to a first model: corners, lenses one by one, mounting.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "host/calibrate/board/image_circle.h"
#include "host/calibrate/rig/rig_terms.h"
#include "host/calibrate/rig/view_set.h"

namespace mixrig::calibration {

/// Print of a set's board. Errors: kUsage for an unknown dictionary.
Result<BoardPrint> print_of(const ViewSet& set);

/// False detections in one camera's pictures.
struct Misfound {
  std::vector<int> views;  ///< left out altogether
  int corners = 0;         ///< number, corners of views that were left out included
};

struct RigData {
  ViewSet set;  ///< cameras that take part
  BoardPrint print;
  Pictures pictures;                                ///< by view, then camera
  SeenCorners corners;                              ///< inside the image circles
  std::vector<std::optional<ImageCircle>> circles;  ///< one for each camera; empty: none is known
  std::vector<Misfound> misfound;                   ///< one for each camera; filled by start_rig()
  double blur_px = 0;                               ///< largest median blur that the detector found
};
/// Reads all pictures of the cameras that `wanted` names (all if empty) and finds the board in
/// them; calls `progress` with the number of views done and of all views. Errors: kUsage,
/// kNotFound, kFormat.
Result<RigData> load_rig_data(const ViewSet& set, const std::vector<std::string>& wanted,
                              Crew& crew, const std::function<void(int, int)>& progress);

/// Image circle of a camera; nullopt unless it is a fisheye whose pictures show one.
std::optional<ImageCircle> circle_of(const RigData& data, std::size_t camera);

/// Views in which a camera sees the board.
std::vector<int> seen_by(const RigData& data, std::size_t camera);

/// Finds lenses, mounting and the board's poses, each good enough to start the joint solution from.
/// Removes false detections from `data`. Errors: kData where a camera sees the board too rarely or
/// always in the same way, where no view is shared with the target camera, or where a lens cannot
/// be found.
Result<RigModel> start_rig(RigData& data, Crew& crew);

/// Root mean square distance (px) of one camera's corners over views, and their number.
struct CornerError {
  double rms_px = 0;
  int corners = 0, views = 0;
};
CornerError corner_error(const RigData& data, const RigModel& model, std::size_t camera,
                         const std::vector<int>& views);

/// Board's pose in a camera from its corners alone; false where the corners do not determine it.
bool board_pose(const RigData& data, const RigModel& model, std::size_t camera, int view,
                geometry::Pose& camera_from_board);

}  // namespace mixrig::calibration
