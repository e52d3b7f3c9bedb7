// SPDX-License-Identifier: Apache-2.0
#include "host/math/config/toml_lines.h"

#include <algorithm>

namespace mixrig::config {

Lines lines_of(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string text_of_lines(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

std::string_view bare(std::string_view line) {
  line = line.substr(0, line.find('#'));
  const auto from = line.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return line.substr(from, line.find_last_not_of(" \t\r") - from + 1);
}

std::string header_of(std::string_view line) {
  const std::string_view text = bare(line);
  if (text.size() < 3 || text.front() != '[' || text.back() != ']') return {};
  std::string header;
  for (const char c : text) {
    if (c == ',' || c == '=') return {};  // an array's row
    if (c != ' ' && c != '\t') header += c;
  }
  return header;
}

std::string_view key_of(std::string_view line) {
  const auto equals = line.find('=');
  return equals == std::string_view::npos ? std::string_view{} : bare(line.substr(0, equals));
}

std::vector<Block> blocks_of(const Lines& lines, std::string_view header) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (header_of(lines[i]) != header) continue;
    std::size_t end = i + 1;
    while (end < lines.size() && header_of(lines[end]).empty()) ++end;
    while (end > i + 1 && bare(lines[end - 1]).empty()) --end;
    blocks.push_back({i, end});
  }
  return blocks;
}

void set_line(Lines& lines, const Block& block, std::string_view key, const std::string& line) {
  for (std::size_t i = block.begin + 1; i < block.end; ++i)
    if (key_of(lines[i]) == key) {
      lines[i] = line;
      return;
    }
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(block.begin) + 1, line);
}

void set_line_in(Lines& lines, Block& block, std::string_view key, const std::string& line) {
  const std::size_t before = lines.size();
  set_line(lines, block, key, line);
  block.end += lines.size() - before;
}

void remove_line(Lines& lines, Block& block, std::string_view key) {
  const auto from = lines.begin() + static_cast<std::ptrdiff_t>(block.begin) + 1;
  const auto to = lines.begin() + static_cast<std::ptrdiff_t>(block.end);
  const auto left =
      std::remove_if(from, to, [&](const std::string& line) { return key_of(line) == key; });
  block.end -= static_cast<std::size_t>(to - left);
  lines.erase(left, to);
}

void set_number(Lines& lines, const Block& block, std::string_view key, double value) {
  std::string line = value_line(key, value);
  for (std::size_t i = block.begin + 1; i < block.end; ++i)
    if (const auto comment = lines[i].find('#');
        key_of(lines[i]) == key && comment != std::string::npos)
      line += "  " + lines[i].substr(comment);
  set_line(lines, block, key, line);
}

}  // namespace mixrig::config
