// SPDX-License-Identifier: Apache-2.0
// A recording that is played as if its devices delivered it now.
#pragma once

#include <memory>

#include "hal/base/clock.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::session {

/// The captures of `source` at its rate (25 Hz where that is unknown), again and again: after the
/// last the first. mid_exposure is the time at which each is delivered. It has no truth.
/// Precondition: the source has frames. `clock` outlives it.
std::unique_ptr<capture::CaptureSource> played(std::unique_ptr<capture::CaptureSource> source,
                                               Clock& clock);

}  // namespace mixrig::session
