// SPDX-License-Identifier: Apache-2.0
// A model as a binary glTF 2.0 file.
#pragma once

#include <filesystem>
#include <string>

#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Writes the meshes of `model`, one node `name`, with their textures (embedded PNG) and gloss,
/// but no other maps, in glTF's axes, y up. The folder must exist. Errors: kIo. Precondition: each
/// mesh has vertices, normals and a uv per vertex, and a texture.
Result<void> write_glb(const Model& model, const std::string& name,
                       const std::filesystem::path& path);

}  // namespace mixrig::scene
