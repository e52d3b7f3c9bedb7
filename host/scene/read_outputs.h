// SPDX-License-Identifier: Apache-2.0
// Reads the tables of scene.toml for the outputs of a run. Private to this module.
#pragma once

#include <filesystem>

#include "host/math/config/table.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// A file's relative path starts at `folder`.
StreamOut read_stream_out(const config::Table& table, const std::filesystem::path& folder);
/// Reads [focus]; nullopt if the table is absent.
std::optional<FocusSettings> read_focus(const config::Table& table);

}  // namespace mixrig::scene
