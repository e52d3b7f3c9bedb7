// SPDX-License-Identifier: Apache-2.0
// Lines as a binary glTF 2.0 file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hal/base/result.h"

namespace mixrig::scene {

struct Polyline {
  std::string name;
  std::vector<Eigen::Vector3f> points_m;  ///< z up
};

/// A node for each line, in glTF's axes, y up. The folder must exist. Errors: kIo. Precondition:
/// each line has two points or more.
Result<void> write_glb_lines(const std::vector<Polyline>& lines, const std::filesystem::path& path);

}  // namespace mixrig::scene
