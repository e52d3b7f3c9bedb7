// SPDX-License-Identifier: Apache-2.0
// Warnings of a take, which a command may open more than once. Private to this module.
#pragma once

#include <string>

namespace mixrig::take {

/// Writes a warning, unless this process has written the same line before. Thread-safe.
void tell_once(const std::string& line);

}  // namespace mixrig::take
