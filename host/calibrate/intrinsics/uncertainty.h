// SPDX-License-Identifier: Apache-2.0
// The uncertainty of projection of a calibration over the picture, and the view that would reduce
// it most.
#pragma once

#include <string>
#include <vector>

#include "host/calibrate/intrinsics/intrinsics.h"

namespace mixrig::calibration {

/// Standard deviation of the pixel of a far point, in its worse direction, at the centres of
/// columns x rows cells; NaN where the lens has no ray, such as beyond its image circle. As mrcal
/// defines it (Kogan, "mean-pcam"): the far point is tied to the boards, whose poses move with the
/// intrinsics, so that a rotation of the whole camera adds no uncertainty.
struct UncertaintyMap {
  int columns = 0, rows = 0;
  std::vector<double> sigma_px;  ///< row by row
  double median_px = 0;
  double rim_px = 0;    ///< the worst at the largest angle inside the picture; 0 where it has none
  double worst_px = 0;  ///< largest sigma of the cells and the rim
};
UncertaintyMap projection_uncertainty(const Intrinsics& intrinsics, int columns, int rows);

/// How many points of the views in use lie in each of columns x rows cells.
std::vector<int> coverage(const Intrinsics& intrinsics, int columns, int rows);

/// Pose for one more view of the board, and the uncertainty of projection before and after it.
struct Advice {
  std::string where;  ///< "in the top left of the picture, tilted by 35 degrees about ..."
  geometry::Pose camera_from_board;
  double mean_now_px = 0, mean_then_px = 0;
};
/// Chooses the best of a set of board poses: nine positions, five tilts, two distances. Adds the
/// information of each candidate to that of the views in use.
Advice advise(const Intrinsics& intrinsics, const BoardSpec& board);

}  // namespace mixrig::calibration
