// SPDX-License-Identifier: Apache-2.0
// Keys of an SRT address, of which GStreamer passes over those that it does not know.
#pragma once

#include <string_view>

#include "hal/base/result.h"

namespace mixrig::output {

/// Checks the part of an SRT address from its question mark on; empty: no keys. Returns whether
/// this end calls the other one. Pure. Errors: kUsage for a key that is not known, since a misspelt
/// passphrase would be sent in the clear, and for values out of range.
Result<bool> srt_calls(std::string_view query);

}  // namespace mixrig::output
