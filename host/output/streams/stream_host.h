// SPDX-License-Identifier: Apache-2.0
// Looks up the host that a stream is sent to, which GStreamer's elements do not all check.
#pragma once

#include <string>

#include "hal/base/result.h"

namespace mixrig::output {

/// Returns the numeric address of a host, IPv4 where it has one. May ask name servers, which takes
/// seconds where none answers. Errors: kUsage for a host that is not known.
Result<std::string> numeric_host(const std::string& host);

}  // namespace mixrig::output
