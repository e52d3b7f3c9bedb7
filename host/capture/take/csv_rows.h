// SPDX-License-Identifier: Apache-2.0
// Reads rows of comma-separated tables. Private to this module.
#pragma once

#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hal/base/result.h"

namespace mixrig::take {

/// Splits a line into cells, at most `most`.
inline std::vector<std::string_view> cells_of(std::string_view line, std::size_t most) {
  std::vector<std::string_view> cells;
  while (cells.size() < most) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) break;
    line.remove_prefix(comma + 1);
  }
  return cells;
}

template <typename Number>
bool parse_cell(std::string_view cell, Number& value) {
  const char* end = cell.data() + cell.size();
  const auto [stop, fault] = std::from_chars(cell.data(), end, value);
  return fault == std::errc() && stop == end && !cell.empty();
}

/// Calls `row(cells)` for each line after the header; a line for which it returns false is an
/// error.
template <typename Row>
Result<void> for_each_row(std::string_view text, const std::string& name, std::size_t columns,
                          Row&& row) {
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    std::string_view words = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!words.empty() && words.back() == '\r') words.remove_suffix(1);
    if (line == 1 || words.empty()) continue;
    const std::vector<std::string_view> cells = cells_of(words, columns + 1);
    if (cells.size() != columns || !row(cells))
      return Error{ErrorCode::kFormat,
                   fmt::format("{}:{}: not a row of {} columns: delete the file to read the take "
                               "without it",
                               name, line, columns)};
  }
  return {};
}

}  // namespace mixrig::take
