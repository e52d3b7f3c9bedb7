// SPDX-License-Identifier: Apache-2.0
// The markers of a tracked body, from a TOML file. docs/reference/scene.md shows it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hal/base/result.h"

namespace mixrig::mocap {

struct Constellation {
  std::string name;
  double sigma_m =
      1e-3;  ///< noise of an observed marker, including the error of its position in this file
  std::vector<Eigen::Vector3d> markers_m;  ///< in body axes, 3 to 64
};

/// Reads a constellation. Errors: kNotFound, kFormat (file:line: key); kData for a constellation
/// that looks the same when turned, naming the markers that can be confused.
Result<Constellation> read_constellation(const std::filesystem::path& path);
/// Parses a constellation; `name` is the file's name in errors. Pure: the entry point of the
/// fuzzer.
Result<Constellation> parse_constellation(std::string_view text, const std::string& name);

}  // namespace mixrig::mocap
