// SPDX-License-Identifier: Apache-2.0
// Systematic error of a depth camera, with as many terms as the data support.
#pragma once

#include "host/calibrate/rig/rig_terms.h"
#include "host/capture/calibration_file/calibration.h"

namespace mixrig::calibration {

/// One choice of terms and its error on views that it was not fitted to.
struct DepthChoice {
  int knots = 0;
  bool amplitude = false, place = false;
  double held_out_m = 0;  ///< root mean square
};

struct DepthFit {
  calibration_file::DepthError error;
  double uncorrected_m = 0;  ///< root mean square of measured - board
  DepthChoice chosen;
  std::vector<DepthChoice> tried;
  double stretch = 0;  ///< relative error of all distances: reveals a board of the wrong size
};

/// Fits every choice with eight folds of views and takes the simplest whose error is that of the
/// best one, within one standard error over views (Breiman, Friedman, Olshen and Stone 1984).
/// Errors: kData with less than 4 views or 50 samples, or where distances span less than 0.1 m.
Result<DepthFit> fit_depth_error(const std::vector<DepthSample>& samples);

}  // namespace mixrig::calibration
