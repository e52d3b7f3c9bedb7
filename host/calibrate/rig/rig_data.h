// SPDX-License-Identifier: Apache-2.0
// Pictures of a view set, and the board's corners in them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/parallel.h"
#include "host/calibrate/board/board.h"
#include "host/calibrate/board/image_circle.h"
#include "host/calibrate/rig/rig_terms.h"
#include "host/calibrate/rig/view_set.h"

namespace mixrig::calibration {

/// The set's board as the detector names it: inner corners of a checkerboard, squares of a ChArUco.
BoardSpec board_of(const ViewSet& set);

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

}  // namespace mixrig::calibration
