// SPDX-License-Identifier: Apache-2.0
// Slows a take down, so that a loaded machine can follow.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace mixrig::test {

/// Multiplies the times of a take with poses.txt by `times`.
inline void slow_down(const std::filesystem::path& take, int times) {
  std::ifstream in(take / "poses.txt");
  std::ostringstream out;
  for (std::string line; std::getline(in, line);) {
    const std::size_t end = line.find(' ');
    if (line.starts_with('#'))
      out << line << '\n';
    else
      out << times * std::stod(line.substr(0, end)) << line.substr(end) << '\n';
  }
  in.close();
  std::ofstream(take / "poses.txt") << out.str();
}

}  // namespace mixrig::test
