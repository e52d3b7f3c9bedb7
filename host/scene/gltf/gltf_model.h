// SPDX-License-Identifier: Apache-2.0
// glTF bytes to a Model. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/scene/scene.h"

namespace mixrig::scene {

/// As load_gltf, from bytes; the files that they name are read only from inside `folder`.
/// `without`, where given, gets what the model has and is drawn without, in words.
/// Errors: kFormat, without the model's name.
Result<Model> parse_model(std::span<const std::uint8_t> bytes, const std::filesystem::path& folder,
                          std::vector<std::string>* without = nullptr);

}  // namespace mixrig::scene
