// SPDX-License-Identifier: Apache-2.0
// What a run found of the room, as JSON and as lines of text.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "host/session/change_sink.h"

namespace mixrig::session {

/// docs/formats.md has the keys.
nlohmann::json to_json(const RoomChangesReport& report);
/// Nothing where nothing changed.
std::string to_lines(const RoomChangesReport& report);

}  // namespace mixrig::session
