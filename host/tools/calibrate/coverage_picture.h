// SPDX-License-Identifier: Apache-2.0
// The picture of what board views cover.
#pragma once

#include "hal/base/image.h"
#include "host/calibrate/views/coverage.h"

namespace mixrig::tools {

/// A panel a camera with the corners of all views, ninths that lack views shaded, and the list of
/// needs with what there is of each.
Image<Rgb8> coverage_picture(const calibration::Coverage& coverage);

}  // namespace mixrig::tools
