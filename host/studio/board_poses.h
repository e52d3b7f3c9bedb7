// SPDX-License-Identifier: Apache-2.0
// Where the board is held in every view.
#pragma once

#include "host/studio/board_studio.h"

namespace mixrig::studio {

struct BoardPlace {
  geometry::Pose target_from_board;
  double pan_rad = 0, tilt_rad = 0;  ///< as the encoders tell
};

/// Place of view `number`: near and far in turn, all corners in the target and the ToF picture,
/// tilted by up to 45 degrees; every fifth one off the axis. With the pan-tilt unit: one place in
/// the room, seen from all sides of the pictures.
BoardPlace board_place(const BoardInfo& info, int number);

}  // namespace mixrig::studio
