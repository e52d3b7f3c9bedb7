// SPDX-License-Identifier: Apache-2.0
// A TOML file as lines: a key is changed, and the rest of the text stays as it is. Pure. Works only
// for files with each table header and each key on a line of its own: parse the result again to
// check it.
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

/// Returns the line without surrounding blanks and without a comment at its end.
std::string_view bare(std::string_view line);
/// Returns the header of a table without blanks, such as "[light]" for "[ light ] # ..."; empty if
/// the line is no header.
std::string header_of(std::string_view line);
/// Returns the key that a line sets, or empty.
std::string_view key_of(std::string_view line);

/// Lines [begin, end) of a table, without the comments and blank lines before the next header.
struct Block {
  std::size_t begin = 0, end = 0;
};
/// Returns all tables with a header, such as "[[camera]]".
std::vector<Block> blocks_of(const Lines& lines, std::string_view header);

/// Returns the line "key = value".
template <typename Value>
std::string value_line(std::string_view key, const Value& value) {
  Writer table;
  table.set(key, value);
  std::string line = table.text();
  while (!line.empty() && line.back() == '\n') line.pop_back();
  return line;
}

/// Sets a key of a table to `line`; a comment behind the old value is lost.
void set_line(Lines& lines, const Block& block, std::string_view key, const std::string& line);
/// Does what set_line() does, and moves block.end if it inserts a line.
void set_line_in(Lines& lines, Block& block, std::string_view key, const std::string& line);
/// Removes a key of a table and moves block.end.
void remove_line(Lines& lines, Block& block, std::string_view key);
/// Sets a number of a table; a comment behind the old value is kept.
void set_number(Lines& lines, const Block& block, std::string_view key, double value);

}  // namespace mixrig::config
