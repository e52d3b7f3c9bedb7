// SPDX-License-Identifier: Apache-2.0
// What a board may really be, where it is not found as stated.
#pragma once

#include <optional>

#include "host/calibration/detect_board.h"

namespace mixrig::calibration {

/// Tries the boards that people mix up with `stated`: one column or row more or less (squares
/// counted for corners), columns and rows exchanged; for a ChArUco, up to three squares more or
/// less, judged by how well one homography fits. nullopt where none is clearly better.
std::optional<BoardSpec> suggest_board(ImageView<const std::uint8_t> image,
                                       const BoardSpec& stated);

/// Root mean square distance, px, of a view's points to the best homography of the board, robust to
/// a quarter of outliers; large where ids do not belong to places.
double homography_misfit_px(const BoardView& view, const BoardSpec& board);

}  // namespace mixrig::calibration
