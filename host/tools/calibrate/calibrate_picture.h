// SPDX-License-Identifier: Apache-2.0
// The picture of a calibration: residuals, uncertainty of projection, error of every view.
#pragma once

#include "hal/base/image.h"
#include "host/calibrate/intrinsics/uncertainty.h"

namespace mixrig::tools {

/// Left: every point with its residual, enlarged. Middle: uncertainty of projection over the
/// picture in colour and figures. Right: a bar a view, those left out in grey.
Image<Rgb8> calibration_picture(const calibration::Intrinsics& intrinsics,
                                const calibration::UncertaintyMap& map);

}  // namespace mixrig::tools
