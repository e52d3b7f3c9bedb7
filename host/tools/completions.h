// SPDX-License-Identifier: Apache-2.0
// Completions of the command line for three shells. Private to the command.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/tools/command.h"

namespace mixrig::tools {

/// A command with the words that choose it: {"calibrate", "rig"}; none for mixrig itself.
struct HelpEntry {
  std::vector<std::string> path;
  const CommandText* text;
  std::string joined(const char* by) const { return fmt::format("{}", fmt::join(path, by)); }
  /// "mixrig calibrate rig", or with '-' as the name of its man page.
  std::string command(char by) const {
    std::string name = "mixrig";
    for (const std::string& word : path) name += by + word;
    return name;
  }
};

/// `text` with each `from` replaced.
std::string replaced(std::string text, const std::string& from, const std::string& to);

std::string bash_completion(const std::vector<HelpEntry>& entries);
std::string zsh_completion(const std::vector<HelpEntry>& entries);
std::string fish_completion(const std::vector<HelpEntry>& entries);

}  // namespace mixrig::tools
