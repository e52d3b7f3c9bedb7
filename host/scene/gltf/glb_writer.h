// SPDX-License-Identifier: Apache-2.0
// Writes models and lines as binary glTF 2.0 files, in glTF's axes, y up.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Writes the meshes of `model`, one node `name`, with their textures (embedded PNG) and gloss,
/// but no other maps. The folder must exist. Errors: kIo. Precondition: each mesh has vertices,
/// normals and a uv per vertex, and a texture.
Result<void> write_glb(const Model& model, const std::string& name,
                       const std::filesystem::path& path);

struct Polyline {
  std::string name;
  std::vector<Eigen::Vector3f> points_m;  ///< z up
};

/// Writes a node for each line. The folder must exist. Errors: kIo. Precondition: each line has at
/// least two points.
Result<void> write_glb(const std::vector<Polyline>& lines, const std::filesystem::path& path);

}  // namespace mixrig::scene
