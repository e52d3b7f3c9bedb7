// SPDX-License-Identifier: Apache-2.0
// A rig whose cameras are the streams of a take.
#pragma once

#include <filesystem>
#include <optional>

#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::session {

/// Writes FOLDER/rig.toml with the colour and depth streams of `take` as devices; makes FOLDER
/// where it is missing. The streams play from `begin` on; without `begin`, as soon as both have
/// started. Errors: kIo.
Result<std::filesystem::path> write_played_rig(const std::filesystem::path& folder,
                                               const std::filesystem::path& take,
                                               std::optional<HostTime> begin);

}  // namespace mixrig::session
