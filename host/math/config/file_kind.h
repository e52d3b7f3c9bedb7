// SPDX-License-Identifier: Apache-2.0
// Kinds of TOML files by the keys that only they have, of other files by their first bytes.
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>

namespace mixrig::config {

/// Returns "this is the file of a take: name that of a scene" where the keys at the top of a file
/// are of another kind than that of a reader who asked for the keys `asked`. Returns an empty text
/// where the kinds agree, one is not known, or the file also has a key of the reader's kind. Kinds
/// are takes, rigs, calibrations, scenes and rooms. Pure.
std::string other_kind(std::span<const std::string> keys,
                       const std::set<std::string, std::less<>>& asked);

/// What a file is that begins with these bytes, and what to do: "a Matroska file: ...". Empty where
/// it may be text or a model, which read_text() reads too. Knows recordings and pictures. Pure.
std::string binary_kind(std::string_view first_bytes);

/// What to do where a file of this name is not there, or is a folder: "name the folder of a take",
/// "name a file". Pure.
std::string advice_for_unread(std::string_view file_name, bool is_folder);

}  // namespace mixrig::config
