// SPDX-License-Identifier: Apache-2.0
// The upper bound of the error of shadows, and scenes that must exceed it.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace mixrig::test {

/// Upper bound of light_shadow_rmse. Takes without any lamp have 0.19 and more.
inline constexpr double kMostShadowRmse = 0.06;

/// Writes a copy of a scene with its first `kept` lamps into the same folder, and gives its path.
inline std::string with_lamps(const std::string& scene, int kept) {
  const std::filesystem::path path(scene);
  const auto out = path.parent_path() / ("lamps_" + std::to_string(kept) + ".toml");
  std::ifstream in(path);
  std::ofstream file(out);
  int lamps = 0;
  bool in_lamp = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("[")) {
      in_lamp = line == "[[light.lamp]]";
      lamps += in_lamp ? 1 : 0;
    }
    if (!in_lamp || lamps <= kept) file << line << "\n";
  }
  return out.string();
}

}  // namespace mixrig::test
