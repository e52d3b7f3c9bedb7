// SPDX-License-Identifier: Apache-2.0
// Figures of a take's depth camera, by `mixrig info --depth`.
#pragma once

#include <nlohmann/json.hpp>

#include "host/capture/capture/capture_source.h"

namespace mixrig::tools {

/// Measures up to 40 captures spread through the source, prints the figures and returns them as
/// JSON. Errors: those of reading; kData where the take has no depth.
Result<nlohmann::json> info_depth(capture::CaptureSource& source);

}  // namespace mixrig::tools
