// SPDX-License-Identifier: Apache-2.0
// Picture of a calibration: residuals, uncertainty of projection, error of every view.
#pragma once

#include "hal/base/image.h"
#include "host/calibrate/intrinsics/uncertainty.h"

namespace mixrig::tools {

/// Draws on the left every point with its residual, enlarged; in the middle the uncertainty of
/// projection over the picture in colour and figures; on the right a bar for each view, views that
/// were left out in grey.
Image<Rgb8> calibration_picture(const calibration::Intrinsics& intrinsics,
                                const calibration::UncertaintyMap& map);

}  // namespace mixrig::tools
