// SPDX-License-Identifier: Apache-2.0
// Log lines to stderr, one category per folder. Never called per frame on the live path.
#pragma once

#include <string_view>

namespace mixrig {

enum class LogLevel { kInfo, kWarning };

/// Lowest level that is written; kWarning at start. Thread-safe.
void set_log_level(LogLevel level);
/// Writes one line "level category: message" to stderr. Thread-safe.
void log(LogLevel level, std::string_view category, std::string_view message);

inline void log_info(std::string_view c, std::string_view m) { log(LogLevel::kInfo, c, m); }
inline void log_warning(std::string_view c, std::string_view m) { log(LogLevel::kWarning, c, m); }

}  // namespace mixrig
