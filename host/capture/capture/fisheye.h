// SPDX-License-Identifier: Apache-2.0
// Which captures hold a picture of a fisheye that has a rate of its own: one rule for live rigs,
// takes and the studio.
#pragma once

#include "hal/base/clock.h"
#include "host/capture/capture/capture.h"

namespace mixrig::capture {

/// How long a picture is held: 1.5 periods of a camera of `rate_hz`; no time where that is 0.
Duration fisheye_hold(double rate_hz);

/// Status of a picture exposed at `picture` in a capture whose plate was exposed at `plate`: kFresh
/// in the `first` capture that has it; in later ones kRepeated while the plate is younger by `hold`
/// at most, then kMissing.
StreamStatus fisheye_status(bool first, HostTime plate, HostTime picture, Duration hold);

/// Takes the fisheye's picture, stamp and counter out; its status stays.
void clear_fisheye(Capture& capture);
/// The same, and its status is kMissing.
void lose_fisheye(Capture& capture);

}  // namespace mixrig::capture
