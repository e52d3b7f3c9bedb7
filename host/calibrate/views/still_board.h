// SPDX-License-Identifier: Apache-2.0
// Whether a board stands still: the motion of its corners against their own noise.
#pragma once

#include <cstddef>
#include <vector>

#include "host/calibrate/board/detect_board.h"

namespace mixrig::calibration {

/// How a board moved over consecutive pictures of one camera.
struct BoardMotion {
  double most_px = 0;    ///< of one picture against the mean of all: root mean square over the
                         ///< board of the affine motion that fits its corners
  double noise_px = 0;   ///< of a corner, an axis: scatter about these affine motions
  double chance_px = 0;  ///< what `most_px` would be of a board at rest, by that noise
  int corners = 0;       ///< that all pictures show
};

/// Of two pictures or more; `corners` is 0 where they share fewer than 4. Pure.
BoardMotion board_motion(const std::vector<BoardView>& views);

/// True where the motion is at most `rest_px` beyond three times what chance gives.
bool is_still(const BoardMotion& motion, double rest_px);

}  // namespace mixrig::calibration
