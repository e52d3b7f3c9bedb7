// SPDX-License-Identifier: Apache-2.0
// Error with which the table of a zooming lens predicts a setting that was left out of it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/math/geometry/lens_table.h"

namespace mixrig::calibration {

/// Distance between where the lens of a node shows a ray and where the table of the others does,
/// over a grid of 9 x 9 pixels of its picture.
struct LeftOutNode {
  geometry::LensEncoders at;
  double rms_px = 0, most_px = 0;
  double focal_pct = 0;  ///< predicted fx less the node's, in percent
};

/// Predicts each node that lies between others: along zoom where it can be left out of its row of
/// zooms, else along focus. Nodes at a border of the table are skipped, since they cannot be
/// predicted by interpolation. The entrance pupil is not judged: a calibration of one setting does
/// not determine it. Errors: those of LensTable::make.
Result<std::vector<LeftOutNode>> leave_one_out(const geometry::LensTable& table);

}  // namespace mixrig::calibration
