// SPDX-License-Identifier: Apache-2.0
// Plays a recording as if its devices delivered it live.
#pragma once

#include <memory>

#include "hal/base/clock.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::session {

/// Returns a source that delivers the captures of `source` at its rate (25 Hz if unknown) and
/// repeats them without end. mid_exposure is the time at which a capture is delivered. It has no
/// truth. Precondition: the source has frames. `clock` must outlive it.
std::unique_ptr<capture::CaptureSource> played(std::unique_ptr<capture::CaptureSource> source,
                                               Clock& clock);

}  // namespace mixrig::session
