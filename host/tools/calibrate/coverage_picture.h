// SPDX-License-Identifier: Apache-2.0
// Picture of the coverage of board views.
#pragma once

#include "hal/base/image.h"
#include "host/calibrate/views/coverage.h"

namespace mixrig::tools {

/// Draws a panel for each camera with the corners of all views and ninths that lack views shaded,
/// and the list of needs with how far each is met.
Image<Rgb8> coverage_picture(const calibration::Coverage& coverage);

}  // namespace mixrig::tools
