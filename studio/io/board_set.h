// SPDX-License-Identifier: Apache-2.0
// Writes a folder of board views with truth from the virtual studio (docs/reference/take.md,
// views.toml).
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>

#include "studio/board/board_studio.h"

namespace mixrig::studio_io {

/// Renders all views, views.toml, ptu.csv (with the pan-tilt unit) and truth/truth.json into
/// `folder`: whole or not at all. `progress` is called after each view with the number done.
/// Errors: kUsage for options out of range or a folder that holds something else, kIo,
/// kUnsupported; kData where `stop` was set before the last view.
Result<studio::BoardInfo> write_board_set(const studio::BoardOptions& options,
                                          const std::filesystem::path& folder,
                                          const std::function<void(int)>& progress,
                                          const std::atomic<bool>* stop = nullptr);

/// truth/truth.json of a board that is not in views: without target_from_board. Errors: kIo.
Result<void> write_board_truth(const studio::BoardInfo& info, const std::filesystem::path& folder);

}  // namespace mixrig::studio_io
