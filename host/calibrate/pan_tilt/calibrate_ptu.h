// SPDX-License-Identifier: Apache-2.0
// The axes of a pan-tilt unit and the camera on it, from views of a board that does not move.
#pragma once

#include "host/calibrate/rig/calibrate_rig.h"
#include "host/math/estimation/pose/pan_tilt_chain.h"

namespace mixrig::calibration {

struct PtuOptions {
  std::string camera;  ///< its name in the set; empty: the first camera of the set
  /// Lens of that camera; solved from the same views if absent, which is far less certain,
  /// because the distance of the board hardly changes.
  std::optional<geometry::AnyCamera> lens;
  int threads = 0;
};

struct PtuReport {
  estimation::PanTiltCalibration solved;
  calibration_file::Calibration calibration;  ///< the solved unit is its pan_tilt
  Eigen::MatrixXd covariance;                 ///< covariance of estimation::calibrate_pan_tilt()
  double repeatability_rad = 0;               ///< spread of each axis that explains the residuals
  double residual_px = 0;  ///< root mean square distance of the corners to the chain's projection
  int views = 0;
  std::vector<std::string> warnings;
};

/// Calibrates a pan-tilt unit. Errors: kUsage for a set without angles; kData where the views do
/// not determine it.
Result<PtuReport> calibrate_ptu(const ViewSet& set, const PtuOptions& options,
                                const RigProgress& progress);

}  // namespace mixrig::calibration
