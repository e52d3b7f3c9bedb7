// SPDX-License-Identifier: Apache-2.0
// Parses glTF bytes as a Model. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/scene/scene.h"

namespace mixrig::scene {

/// Parses the bytes of a .gltf or .glb file; files that they name are read only from inside
/// `folder`. `without`, if not null, gets the features of the file that are not drawn, in words.
/// Errors: kFormat, without the model's name.
Result<Model> parse_model(std::span<const std::uint8_t> bytes, const std::filesystem::path& folder,
                          std::vector<std::string>* without = nullptr);

}  // namespace mixrig::scene
