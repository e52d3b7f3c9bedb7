// SPDX-License-Identifier: Apache-2.0
// Decides which captures hold a picture of a fisheye with its own frame rate: one rule for live
// rigs, takes and the studio.
#pragma once

#include "hal/base/clock.h"
#include "host/capture/capture/capture.h"

namespace mixrig::capture {

/// Returns how long a picture is held: 1.5 periods of a camera of `rate_hz`; 0 if that is 0.
Duration fisheye_hold(double rate_hz);

/// Returns the status of a picture exposed at `picture` in a capture whose plate was exposed at
/// `plate`: kFresh in the `first` capture that has it; in later ones kRepeated while the plate is
/// at most `hold` younger, then kMissing.
StreamStatus fisheye_status(bool first, HostTime plate, HostTime picture, Duration hold);

/// Removes the fisheye's picture, stamp and counter; keeps its status.
void clear_fisheye(Capture& capture);
/// Removes the fisheye's picture, stamp and counter, and sets its status to kMissing.
void lose_fisheye(Capture& capture);

}  // namespace mixrig::capture
