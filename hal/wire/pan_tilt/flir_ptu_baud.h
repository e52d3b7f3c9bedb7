// SPDX-License-Identifier: Apache-2.0
// Finds the rate of a pan-tilt unit's serial line.
#pragma once

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/byte_stream.h"

namespace mixrig::device {

/// Asks for a position at 9600, 19200, 38400, 57600 and 115200 baud, twice each at most, and leaves
/// the line at the rate of the first valid answer. At a wrong rate the unit receives wrong bytes,
/// which it refuses; no query moves it. Takes up to four seconds.
/// Errors: kTimeout where nothing answers; those of the line.
Result<int> find_ptu_baud(ByteStream& line, Clock& clock);

}  // namespace mixrig::device
