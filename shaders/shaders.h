// SPDX-License-Identifier: Apache-2.0
// The shader stages of this folder as text, embedded at build time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mixrig::shaders {

/// One stage, ready to compile: `#include` lines are expanded.
struct Stage {
  std::string_view name;                ///< file name, "mix.frag"
  std::string_view text;                ///< GLSL ES 3.10
  std::vector<std::string_view> files;  ///< file of each source string number in a compile log
};

/// All stages of the folder, sorted by name. Lives as long as the program.
const std::vector<Stage>& all_stages();

/// The stage with this name; nullptr if there is none.
const Stage* find_stage(std::string_view name);

/// Rewrites "number:line" or "number(line)" in a compiler's log to "file:line".
std::string name_files(std::string_view log, const std::vector<std::string_view>& files);

}  // namespace mixrig::shaders
