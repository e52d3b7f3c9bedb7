// SPDX-License-Identifier: Apache-2.0
// Holds a recording in memory: reading is a copy, so that a measurement in real time does not
// include the recording's decoder.
#pragma once

#include <memory>

#include "host/capture/capture/capture_source.h"

namespace mixrig::capture {

/// Reads all captures once. Truth is not kept: read_truth() reads it from the source. Errors: those
/// of reading; kUsage for an endless source.
Result<std::unique_ptr<CaptureSource>> preloaded(std::unique_ptr<CaptureSource> source);

/// Returns a source of `frames` captures that repeats `source` from its first capture; times
/// continue at its rate. It has no truth. Preconditions: the source has an end, frames and a rate.
std::unique_ptr<CaptureSource> repeated(std::unique_ptr<CaptureSource> source, int frames);

}  // namespace mixrig::capture
