// SPDX-License-Identifier: Apache-2.0
// Leaves out depth that is nearer than the light can come from.
#pragma once

#include <memory>

#include "host/capture/capture/capture_source.h"

namespace mixrig::capture {

/// The same captures, wrapped depth unknown (depth::WrappedDepth), where amplitudes are light; the
/// source unchanged where they are not.
std::unique_ptr<CaptureSource> without_wrapped_depth(std::unique_ptr<CaptureSource> source);

}  // namespace mixrig::capture
