// SPDX-License-Identifier: Apache-2.0
// Keeps the last lines of the log for display.
#pragma once

#include <string>
#include <vector>

namespace mixrig {

/// Returns the last 50 lines that were written, "level category: message", the newest last.
/// Thread-safe.
std::vector<std::string> recent_log_lines();

}  // namespace mixrig
