// SPDX-License-Identifier: Apache-2.0
// First model of a rig from the corners of its views: lenses one by one, then mounting.
#pragma once

#include <vector>

#include "host/calibrate/rig/rig_data.h"

namespace mixrig::calibration {

/// Finds lenses, mounting and the board's poses, each good enough to start the joint solution from.
/// Removes false detections from `data`. Errors: kData where a camera sees the board too rarely or
/// always in the same way, where no view is shared with the target camera, where a lens cannot be
/// found, or where a board that looks the same upside down leaves the mounting open.
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
