// SPDX-License-Identifier: Apache-2.0
// Uncertainty that a calibrated depth error leaves.
#pragma once

#include "host/capture/calibration_file/calibration.h"

namespace mixrig::calibration_file {

/// Returns the standard deviation, m, of the spline of the error at a measured distance, from its
/// covariance; 0 if that is unknown.
double depth_sigma_m(const DepthError& error, double distance_m);

}  // namespace mixrig::calibration_file
