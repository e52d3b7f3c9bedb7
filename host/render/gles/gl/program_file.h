// SPDX-License-Identifier: Apache-2.0
// Linked programs in the driver's binary format, kept as files between runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace mixrig::render::gles {

struct ProgramBinary {
  std::uint32_t format = 0;  ///< the driver's format number
  std::string_view bytes;
};

/// FNV-1a 64 hash of texts with their lengths. A program's key covers the driver's name and version
/// and the text of each stage.
std::uint64_t program_key(std::initializer_list<std::string_view> texts);

/// Serialises a program: magic, key, format, number of bytes, FNV-1a 64 of both, the bytes. Pure.
std::string to_program_file(std::uint64_t key, const ProgramBinary& binary);
/// Reads the binary of a file; it points into `file`. Nullopt if the key differs or the file is
/// truncated, too long or damaged. Pure.
std::optional<ProgramBinary> from_program_file(std::uint64_t key, std::string_view file);

/// Folder of the files, from $XDG_CACHE_HOME or else $HOME/.cache; empty if neither is an absolute
/// path, then nothing is kept.
std::filesystem::path program_folder();

/// Content of a file of at most 16 MB; empty if there is none.
std::string read_program_file(const std::filesystem::path& path);

}  // namespace mixrig::render::gles
