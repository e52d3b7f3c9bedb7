// SPDX-License-Identifier: Apache-2.0
// Refinement of all corners of a view. Private to this module.
#pragma once

#include "host/calibrate/board/detect_board.h"

namespace mixrig::calibration {

/// Fits every corner in the largest window without other edges; corners without a fit are
/// dropped. Fills blur_px, contrast and sigma_px.
BoardView refine_corners(ImageView<const std::uint8_t> image, const BoardSpec& board,
                         const BoardView& rough);

}  // namespace mixrig::calibration
