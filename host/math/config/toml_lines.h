// SPDX-License-Identifier: Apache-2.0
// A TOML file as lines: a key is changed, and the rest of the text stays as it is. Pure. Only files
// that are written with a table's header and each key on a line of its own; who edits one reads the
// result again.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "host/math/config/writer.h"

namespace mixrig::config {

using Lines = std::vector<std::string>;

Lines lines_of(std::string_view text);
std::string text_of_lines(const Lines& lines);

/// The line without blanks around it and without a comment at its end.
std::string_view bare(std::string_view line);
/// "[light]" of "[ light ] # ...": the header of a table, without blanks; else empty.
std::string header_of(std::string_view line);
/// The key that a line sets, or empty.
std::string_view key_of(std::string_view line);

/// Lines [begin, end) of a table; comments and blank lines before the next header are not in it.
struct Block {
  std::size_t begin = 0, end = 0;
};
/// All tables with a header, such as "[[camera]]".
std::vector<Block> blocks_of(const Lines& lines, std::string_view header);

/// "key = value".
template <typename Value>
std::string value_line(std::string_view key, const Value& value) {
  Writer table;
  table.set(key, value);
  std::string line = table.text();
  while (!line.empty() && line.back() == '\n') line.pop_back();
  return line;
}

/// Sets a key of a table; a comment behind the old value goes.
void set_line(Lines& lines, const Block& block, std::string_view key, const std::string& line);
/// The same, of a table whose end follows.
void set_line_in(Lines& lines, Block& block, std::string_view key, const std::string& line);
/// Removes a key of a table, whose end follows.
void remove_line(Lines& lines, Block& block, std::string_view key);
/// Sets a number of a table; a comment behind the old one stays.
void set_number(Lines& lines, const Block& block, std::string_view key, double value);

}  // namespace mixrig::config
