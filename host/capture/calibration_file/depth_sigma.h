// SPDX-License-Identifier: Apache-2.0
// What a calibrated depth error leaves unknown.
#pragma once

#include "host/capture/calibration_file/calibration.h"

namespace mixrig::calibration_file {

/// Sigma of the error at a measured distance, along its spline, by its covariance; 0 where that is
/// not known.
double depth_sigma_m(const DepthError& error, double distance_m);

}  // namespace mixrig::calibration_file
