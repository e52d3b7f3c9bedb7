// SPDX-License-Identifier: Apache-2.0
// Tables of scene.toml that tell what a run sends. Private to this module.
#pragma once

#include "host/math/config/table.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

StreamOut read_stream_out(const config::Table& table);
/// nullopt where the table is absent.
std::optional<FocusSettings> read_focus(const config::Table& table);

}  // namespace mixrig::scene
