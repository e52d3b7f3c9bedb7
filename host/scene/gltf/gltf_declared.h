// SPDX-License-Identifier: Apache-2.0
// What a glTF file says of itself, looked at before its data is parsed. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::scene {

/// Checks a file by its JSON; in `brief` "data:17" stands for a text that begins at 17 in `json`:
/// that it is glTF 2.0, needs only extensions that are read, and that its buffers lie in `folder`,
/// and that its pictures, by their headers in `bin`, the buffer of a .glb, in texts and in files of
/// `folder`, are not too large. Returns what it has and is drawn without, in words, none twice.
/// Errors: kFormat, without the file's name.
Result<std::vector<std::string>> check_declared(std::string_view brief,
                                                std::span<const std::uint8_t> json,
                                                std::span<const std::uint8_t> bin,
                                                const std::filesystem::path& folder);

/// Returns the picture format of a texture extension in words, such as "WebP"; empty for other
/// extensions.
std::string picture_format_of(const std::string& extension);

/// Returns the file inside `folder` that a URI leads to ("%20" is a blank), like file_inside().
std::filesystem::path file_of_uri(const std::string& uri, const std::filesystem::path& folder);

/// Returns the file inside `folder` that a name or path leads to; empty if it is outside or does
/// not exist.
std::filesystem::path file_inside(const std::string& name, const std::filesystem::path& folder);

}  // namespace mixrig::scene
