// SPDX-License-Identifier: Apache-2.0
// A glTF file as tinygltf parses it, with its pictures still encoded. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "hal/base/result.h"

namespace mixrig::scene {

struct GltfFile {
  tinygltf::Model gltf;
  std::vector<std::vector<std::uint8_t>> pictures;  ///< external ones; those in a buffer are empty
  std::vector<std::string> without;                 ///< what it has and is drawn without, in words
};

/// Parses .gltf or .glb bytes; files that it names are read only from inside `folder`.
/// Errors: kFormat, without the file's name.
Result<GltfFile> parse_gltf(std::span<const std::uint8_t> bytes,
                            const std::filesystem::path& folder);

/// Returns Error{kFormat, why}; load_gltf() adds the file's name.
Error bad_gltf(const std::string& why);

}  // namespace mixrig::scene
