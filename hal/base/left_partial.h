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

/// Renames a folder under which PartialPath would write: NAME.partial becomes NAME.1.partial, or
/// the first number that is free, and one line in the log says so. Errors: kUsage where a program
/// holds the folder, or a folder in it, with flock(2) to write there; kIo.
Result<void> set_aside_left(const std::filesystem::path& wanted);

}  // namespace mixrig
