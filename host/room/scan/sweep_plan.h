// SPDX-License-Identifier: Apache-2.0
// Views of a pan-tilt unit whose pictures cover a field of directions.
#pragma once

#include <optional>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::model {

/// Angles of the head; pan grows to the left, tilt upwards.
struct HeadView {
  double pan_rad = 0, tilt_rad = 0;
};

/// Field to be covered, centred on pan = tilt = 0, and the camera that covers it.
struct SweepTask {
  double field_pan_rad = 0, field_tilt_rad = 0;    ///< up to 2 pi and pi
  double camera_pan_rad = 0, camera_tilt_rad = 0;  ///< field of view of the depth camera, below pi
  double overlap = 0.1;  ///< share of a view's width and height seen by neighbours, 0..0.9
  double most_pan_rad = 0, most_tilt_rad = 0;  ///< limits of the unit to both sides
  std::optional<double> most_down_rad{};       ///< limit of tilt downwards; absent: as upwards
  int most_views = 0;  ///< with more, a lower field of the same width is planned; 0: no limit
};

struct SweepPlan {
  std::vector<HeadView> views;  ///< row by row from below, each row against the one before
  double field_tilt_rad = 0;    ///< planned height of the field; less than asked by most_views
  double covered_share = 0;     ///< share of the requested field's solid angle; below 1 where the
                                ///< unit's limits or the number of views leave out some
};

/// Plans rows of equal tilt; every row has as few views as cover its band of elevations, fewer
/// towards the poles. The number of rows is the one with the fewest views in all. Found by trying
/// directions 1.5 degrees apart. Errors: kUsage for values out of range, where no plan covers the
/// field, and where `most_views` do not cover a row.
Result<SweepPlan> plan_sweep(const SweepTask& task);

/// Whether the camera of `task` at `view` sees a direction (azimuth as pan, elevation as tilt),
/// with its field of view reduced by the factor `part`.
bool sees(const SweepTask& task, const HeadView& view, double azimuth_rad, double elevation_rad,
          double part = 1);

}  // namespace mixrig::model
