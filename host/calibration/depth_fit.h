// SPDX-License-Identifier: Apache-2.0
// The systematic error of a depth camera: as many terms as the data support.
#pragma once

#include "host/calibration/rig_terms.h"
#include "host/camera_io/calibration.h"

namespace mixrig::calibration {

/// One choice of terms and what it leaves on views that it was not fitted to.
struct DepthChoice {
  int knots = 0;
  bool amplitude = false, place = false;
  double held_out_m = 0;  ///< root mean square
};

struct DepthFit {
  camera_io::DepthError error;
  double uncorrected_m = 0;  ///< root mean square of measured - board
  DepthChoice chosen;
  std::vector<DepthChoice> tried;
  double stretch = 0;  ///< of all distances, a share: a board of the wrong size shows here
};

/// Fits every choice with eight folds of views and takes the simplest that leaves no more than the
/// best one, within one standard error over views (Breiman, Friedman, Olshen and Stone 1984).
/// Errors: kData with less than 4 views or 50 samples, or where distances span less than 0.1 m.
Result<DepthFit> fit_depth_error(const std::vector<DepthSample>& samples);

}  // namespace mixrig::calibration
