// SPDX-License-Identifier: Apache-2.0
// Pictures of one camera, with the board found in them.
#pragma once

#include <string>
#include <vector>

#include "host/calibrate/intrinsics/intrinsics.h"

namespace mixrig::tools {

struct BoardViews {
  Size size_px;  ///< size of all pictures
  std::vector<calibration::ObservedView> views;
  std::vector<std::string> without;         ///< names of the pictures that do not show the board
  calibration::BrightestPicture brightest;  ///< of all pictures
  bool older_layout = false;  ///< ChArUco: most pictures that tell show OpenCV's older layout
};

/// Keeps freed memory for the next picture: finders allocate whole pictures again and again, and
/// the kernel would clear each anew (a third of the time to find boards). For the whole process.
void keep_freed_memory();

/// Finds the board in every picture, with a progress bar. Errors: those of reading; kData where
/// sizes differ, or where no picture shows the board, with the board that one shows.
Result<BoardViews> collect_views(const std::vector<std::string>& images,
                                 const calibration::BoardSpec& board);

/// Checks, before any camera is fitted, that corner ids fit their positions: ids in wrong places
/// would distort every view. Errors: kData, with the board that fits.
Result<void> check_board(const std::vector<std::string>& images,
                         const calibration::BoardSpec& board, const BoardViews& all);

}  // namespace mixrig::tools
