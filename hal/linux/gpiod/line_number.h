// SPDX-License-Identifier: Apache-2.0
// Parses the number of a GPIO line. Private to this module.
#pragma once

#include <charconv>
#include <optional>
#include <string>

namespace mixrig::device {

/// Returns `text` as a number; empty if not all of it is one.
inline std::optional<unsigned> line_number(const std::string& text) {
  unsigned number = 0;
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace mixrig::device
