// SPDX-License-Identifier: Apache-2.0
// What a calibration is worth where it is used: the uncertainty of projection over the picture, and
// the view that would lower it most.
#pragma once

#include <string>
#include <vector>

#include "host/calibration/intrinsics.h"

namespace mixrig::calibration {

/// Standard deviation of the pixel of a far point, in its worse direction, at the centres of
/// columns x rows cells; NaN where the lens has no ray. As mrcal defines it (Kogan, "mean-pcam"):
/// the far point is tied to the boards, whose poses move with the intrinsics, so that a turn of the
/// whole camera costs nothing.
struct UncertaintyMap {
  int columns = 0, rows = 0;
  std::vector<double> sigma_px;  ///< row by row
  double median_px = 0, worst_px = 0;
};
UncertaintyMap projection_uncertainty(const Intrinsics& intrinsics, int columns, int rows);

/// How many points of the views in use lie in each of columns x rows cells.
std::vector<int> coverage(const Intrinsics& intrinsics, int columns, int rows);

/// One more view, and what it would do to the mean variance of projection.
struct Advice {
  std::string where;  ///< "in the top left of the picture, tilted by 35 degrees about ..."
  geometry::Pose camera_from_board;
  double mean_now_px = 0, mean_then_px = 0;
};
/// The best of a set of views that one could hold the board in: nine places, five tilts, two
/// distances. Solved, not guessed: each view's information is added to what is there.
Advice advise(const Intrinsics& intrinsics, const BoardSpec& board);

}  // namespace mixrig::calibration
