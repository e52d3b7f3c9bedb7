// SPDX-License-Identifier: Apache-2.0
// Mounting of a camera from poses of the board, where pictures may number its corners otherwise: a
// board that looks the same when it is turned.
#pragma once

#include <vector>

#include "host/calibrate/rig/rig_data.h"

namespace mixrig::calibration {

/// Returns the quarter turns about its normal after which the board looks the same, always with 0.
/// A checkerboard of an odd and an even number of squares and a ChArUco have no other.
std::vector<int> alike_turns(const ViewSet& set);

/// Turns the numbering of the corners by quarter turns, and the pose that goes with it: what the
/// camera sees stays the same.
void turn_numbering(const ViewSet& set, int quarter_turns, std::vector<SeenCorner>& corners,
                    geometry::Pose& camera_from_board);

/// Returns the angle between two orientations of the board, rad: the least over those that look the
/// same.
double angle_between(const ViewSet& set, const geometry::Pose& a, const geometry::Pose& b);

/// Finds camera_from_target: the pose that agrees best with all views that the camera shares with
/// the target camera. Numbers the corners of each view that is `placed` (its target_from_board in
/// `rig` is set) so that they agree with it, in `data` and in `single`, the camera's own solution.
/// Errors: kData where less than three views are shared, or where another numbering agrees almost
/// as well.
Result<geometry::Pose> find_mounting(RigData& data, const RigModel& rig,
                                     const std::vector<bool>& placed, std::size_t camera,
                                     RigModel& single);

}  // namespace mixrig::calibration
