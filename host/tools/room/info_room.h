// SPDX-License-Identifier: Apache-2.0
// Description of a scanned room by `mixrig info`.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "hal/base/result.h"

namespace mixrig::tools {

struct InfoRoomOptions {
  std::filesystem::path room;
  std::filesystem::path truth;    ///< take of the sweep with its truth; empty: none
  std::filesystem::path picture;  ///< PNG of plan and elevation to write; empty: none
};

/// Prints the description and returns it as JSON. Errors: those of reading the room and its truth;
/// kIo.
Result<nlohmann::json> info_room(const InfoRoomOptions& options);

}  // namespace mixrig::tools
