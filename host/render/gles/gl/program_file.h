// SPDX-License-Identifier: Apache-2.0
// Linked programs as the driver gives them, kept as files between runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace mixrig::render::gles {

struct ProgramBinary {
  std::uint32_t format = 0;  ///< of the driver
  std::string_view bytes;
};

/// FNV-1a 64 of texts, each with its length: what a binary depends on (the driver's name and
/// version, the text of each stage).
std::uint64_t program_key(std::initializer_list<std::string_view> texts);

/// A file: magic, key, format, number of bytes, FNV-1a 64 of both, the bytes. Pure.
std::string to_program_file(std::uint64_t key, const ProgramBinary& binary);
/// The binary of a file, which it points into; nothing for another key, and for a file that is cut
/// off, too long or damaged. Pure.
std::optional<ProgramBinary> from_program_file(std::uint64_t key, std::string_view file);

/// Folder of the files, by $XDG_CACHE_HOME or else $HOME/.cache; empty where neither is an absolute
/// path: nothing is kept.
std::filesystem::path program_folder();

/// A file of at most 16 MB; empty where there is none.
std::string read_program_file(const std::filesystem::path& path);

}  // namespace mixrig::render::gles
