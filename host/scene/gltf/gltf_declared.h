// SPDX-License-Identifier: Apache-2.0
// What a glTF file says of itself, looked at before its data is parsed. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::scene {

/// Checks the JSON of a file: that it is glTF 2.0, needs only extensions that are read, and that
/// its buffers lie in `folder`, and that its pictures in `bin`, the buffer of a .glb, are not too
/// large. Returns what it has and is drawn without, in words, none twice.
/// Errors: kFormat, without the file's name.
Result<std::vector<std::string>> check_declared(std::span<const std::uint8_t> json,
                                                std::span<const std::uint8_t> bin,
                                                const std::filesystem::path& folder);

/// Returns the picture format of a texture extension in words, such as "WebP"; empty for other
/// extensions.
std::string picture_format_of(const std::string& extension);

/// Returns the file inside `folder` that a name or path leads to; empty if it is outside or does
/// not exist.
std::filesystem::path file_inside(const std::string& name, const std::filesystem::path& folder);

}  // namespace mixrig::scene
