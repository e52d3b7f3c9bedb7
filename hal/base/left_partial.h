// SPDX-License-Identifier: Apache-2.0
// What a recording that was cut off has left under its partial name (partial_path.h).
#pragma once

#include <filesystem>

#include "hal/base/result.h"

namespace mixrig {

/// Returns the path under which a recording of this name is written until it is whole.
std::filesystem::path partial_of(const std::filesystem::path& wanted);

/// Returns whether a file, or a folder that is not empty, has the partial name of `wanted`.
inline bool has_left_partial(const std::filesystem::path& wanted) {
  std::error_code error;
  const std::filesystem::path partial = partial_of(wanted);
  return std::filesystem::exists(partial, error) && !std::filesystem::is_empty(partial, error);
}

/// Refuses a name under which PartialPath would remove what an earlier recording left. Errors:
/// kUsage.
inline Result<void> refuse_left_partial(const std::filesystem::path& wanted) {
  if (!has_left_partial(wanted)) return {};
  return Error{ErrorCode::kUsage, "'" + partial_of(wanted).string() +
                                      "' holds what a recording that was cut off has left: "
                                      "mixrig info --repair makes a take of it; or move it to "
                                      "another name or remove it, or give another name"};
}

}  // namespace mixrig
