// SPDX-License-Identifier: Apache-2.0
// Angles of a pan-tilt unit at which its cameras see a board that stands still.
#pragma once

#include <vector>

#include "hal/device/pan_tilt.h"
#include "host/calibrate/board/detect_board.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::calibration {

/// Largest turn of the unit to either side that keeps a board seen at `board` in the picture.
/// `camera`: a guess of the camera's lens. 0 where the board fills the picture.
device::PanTiltAngles turn_reach(const BoardView& board, const geometry::CameraModel& camera);

/// `views` angles within `reach` of `middle` and within the limits of the unit, spread evenly
/// (Halton sequence of bases 2 and 3), the middle first.
std::vector<device::PanTiltAngles> turn_angles(device::PanTiltAngles middle,
                                               device::PanTiltAngles reach, int views,
                                               const device::PanTiltInfo& unit);

}  // namespace mixrig::calibration
