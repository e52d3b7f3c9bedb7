// SPDX-License-Identifier: Apache-2.0
// How well the views determine a rig: each camera by itself, and the way between two cameras.
#pragma once

#include "host/calibrate/intrinsics/intrinsics.h"
#include "host/calibrate/rig/normal_equations.h"
#include "host/calibrate/rig/rig_data.h"

namespace mixrig::calibration {

/// One camera's corners, lens and board poses as a calibration of that camera alone, for
/// projection_uncertainty() and advise(). Without covariance, held-out error and views by name.
Intrinsics seen_alone(const RigData& data, const RigModel& model, std::size_t camera,
                      const std::vector<int>& views);

/// Standard deviation (px) of where the target camera sees a point that another camera sees and
/// measures the distance of, in its worse direction, from the covariance of both lenses and their
/// mounting.
struct Registration {
  std::string camera;
  double distance_m = 0;               ///< of the point: the median of the board's
  double median_px = 0, worst_px = 0;  ///< over a grid of the other camera's pixels that the target
                                       ///< camera sees; 0 where it sees none
};
/// `layout` and `covariance` are those of the solution, `views` the views in it.
Registration registration_of(const RigModel& model, const RigLayout& layout,
                             const Eigen::MatrixXd& covariance, std::size_t camera,
                             const std::vector<int>& views);

}  // namespace mixrig::calibration
