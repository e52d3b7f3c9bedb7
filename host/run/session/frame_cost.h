// SPDX-License-Identifier: Apache-2.0
// Measures the cost of a session's frame on this machine.
#pragma once

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Median milliseconds of `frames` composites of one capture by a new compositor with the session's
/// setup and back end, after `warm_up` frames that fill caches. Each pose differs by `step_m` from
/// the last. Errors: those of the back end.
Result<double> frame_cost_ms(const Session& session, const capture::Capture& capture, int warm_up,
                             int frames, double step_m, const Clock& clock);

}  // namespace mixrig::session
