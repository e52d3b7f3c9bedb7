// SPDX-License-Identifier: Apache-2.0
// The last lines of the log, for who shows them.
#pragma once

#include <string>
#include <vector>

namespace mixrig {

/// The last 50 lines that were written, "level category: message", the newest last. Thread-safe.
std::vector<std::string> recent_log_lines();

}  // namespace mixrig
