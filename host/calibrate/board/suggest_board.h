// SPDX-License-Identifier: Apache-2.0
// Which board the picture may show, where the stated one is not found.
#pragma once

#include <optional>

#include "host/calibrate/board/detect_board.h"

namespace mixrig::calibration {

/// Tries the boards that are often confused with `stated`: one column or row more or less (squares
/// counted for corners), columns and rows exchanged; for a ChArUco, up to three squares more or
/// less, judged by how well one homography fits. nullopt where none is clearly better.
std::optional<BoardSpec> suggest_board(ImageView<const std::uint8_t> image,
                                       const BoardSpec& stated);

/// Root mean square distance, px, of a view's points to the best homography of the board, robust to
/// a quarter of outliers; large where ids do not match positions.
double homography_misfit_px(const BoardView& view, const BoardSpec& board);

}  // namespace mixrig::calibration
