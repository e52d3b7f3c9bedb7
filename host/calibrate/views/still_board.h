// SPDX-License-Identifier: Apache-2.0
// Finds whether a board stands still, by the motion of its corners against their noise.
#pragma once

#include <cstddef>
#include <vector>

#include "host/calibrate/board/detect_board.h"

namespace mixrig::calibration {

/// How a board moved over consecutive pictures of one camera.
struct BoardMotion {
  double most_px = 0;    ///< largest motion of a picture against the mean of all: root mean square
                         ///< over the corners of the affine motion that fits them
  double noise_px = 0;   ///< standard deviation of a corner from that motion, for each axis
  double chance_px = 0;  ///< `most_px` that this noise alone would give
  int corners = 0;       ///< number of corners that all pictures show
};

/// Compares two pictures or more; `corners` is 0 where they share fewer than 4 corners. Pure.
BoardMotion board_motion(const std::vector<BoardView>& views);

/// True where the motion is at most `rest_px`, added in quadrature to three times the motion that
/// noise gives.
bool is_still(const BoardMotion& motion, double rest_px);

}  // namespace mixrig::calibration
