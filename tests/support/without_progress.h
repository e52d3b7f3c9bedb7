// SPDX-License-Identifier: Apache-2.0
// What a command writes to stderr, without the lines of its progress, which a slow machine has.
#pragma once

#include <regex>
#include <sstream>
#include <string>

namespace mixrig::test {

inline std::string without_progress(const std::string& text) {
  static const std::regex progress(R"([a-z][a-z ,]* \d+/\d+(, .* left)?)");
  std::istringstream lines(text);
  std::string line, rest;
  while (std::getline(lines, line))
    if (!std::regex_match(line, progress)) rest += line + (lines.eof() ? "" : "\n");
  return rest;
}

}  // namespace mixrig::test
