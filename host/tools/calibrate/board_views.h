// SPDX-License-Identifier: Apache-2.0
// Pictures of one camera, and the board in them.
#pragma once

#include <string>
#include <vector>

#include "host/calibrate/intrinsics/intrinsics.h"

namespace mixrig::tools {

struct BoardViews {
  Size size_px;  ///< of all pictures
  std::vector<calibration::ObservedView> views;
  std::vector<std::string> without;         ///< names of the pictures that do not show the board
  calibration::BrightestPicture brightest;  ///< of all pictures
};

/// Finds the board in every picture, with progress. Errors: those of reading; kData where sizes
/// differ, or where no picture shows the board, with the board that one shows.
Result<BoardViews> collect_views(const std::vector<std::string>& images,
                                 const calibration::BoardSpec& board);

/// Ids in wrong places distort every view: checked before any camera is fitted. Errors: kData, with
/// the board that fits.
Result<void> check_board(const std::vector<std::string>& images,
                         const calibration::BoardSpec& board, const BoardViews& all);

}  // namespace mixrig::tools
