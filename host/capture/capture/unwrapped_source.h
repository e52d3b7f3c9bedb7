// SPDX-License-Identifier: Apache-2.0
// Removes depth that phase wrap made too near.
#pragma once

#include <memory>

#include "host/capture/capture/capture_source.h"

namespace mixrig::capture {

/// Wraps a source whose amplitudes are light: wrapped depth becomes unknown (depth::WrappedDepth).
/// Returns other sources unchanged.
std::unique_ptr<CaptureSource> without_wrapped_depth(std::unique_ptr<CaptureSource> source);

}  // namespace mixrig::capture
