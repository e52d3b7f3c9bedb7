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

/// What is to be covered, centred on pan = tilt = 0, and by what camera.
struct SweepTask {
  double field_pan_rad = 0, field_tilt_rad = 0;    ///< up to 2 pi and pi
  double camera_pan_rad = 0, camera_tilt_rad = 0;  ///< field of view of the depth camera, below pi
  double overlap = 0.1;  ///< share of a view's width and height that its neighbours see too, 0..0.9
  double most_pan_rad = 0, most_tilt_rad = 0;  ///< the unit turns that far to both sides
  std::optional<double> most_down_rad{};       ///< tilt downwards, where it is not that upwards
  int most_views = 0;  ///< so many cover a lower field of the same width; 0: as many as it takes
};

struct SweepPlan {
  std::vector<HeadView> views;  ///< row by row from below, each row against the one before
  double field_tilt_rad = 0;    ///< height of the field that was planned for
  double covered_share = 0;     ///< of the solid angle of the field that was asked for; below 1
                                ///< where the unit's limits or the number of views leave out some
};

/// Rows of equal tilt; every row has as few views as cover its band of elevations, fewer towards
/// the poles. The number of rows is that which needs the fewest views. Found by trying directions
/// 1.5 degrees apart. Errors: kUsage for values out of range, and where `most_views` do not cover a
/// row.
Result<SweepPlan> plan_sweep(const SweepTask& task);

/// Whether the camera of `task` at `view` sees a direction (azimuth as pan, elevation as tilt). Its
/// field of view is made smaller by the factor `part`.
bool sees(const SweepTask& task, const HeadView& view, double azimuth_rad, double elevation_rad,
          double part = 1);

}  // namespace mixrig::model
