// SPDX-License-Identifier: Apache-2.0
// The pose of the board in every view.
#pragma once

#include "studio/board/board_studio.h"

namespace mixrig::studio {

struct BoardPlace {
  geometry::Pose target_from_board;
  double pan_rad = 0, tilt_rad = 0;  ///< as the encoders report
};

/// Pose of view `number`: near and far distances mixed, all corners in the target and the ToF
/// picture, tilted by up to 45 degrees; every fifth view is far off the axis. With the pan-tilt
/// unit the board is fixed in the room and appears in all parts of the pictures.
BoardPlace board_place(const BoardInfo& info, int number);

}  // namespace mixrig::studio
