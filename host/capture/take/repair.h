// SPDX-License-Identifier: Apache-2.0
// Makes a take of what a recording that was cut off has left.
#pragma once

#include <filesystem>
#include <string>

#include "hal/base/result.h"

namespace mixrig::take {

struct Repaired {
  std::filesystem::path folder;  ///< its name now
  std::filesystem::path take;    ///< the take in it: the folder itself, or its composite/
  std::string what;              ///< one line: frames that were taken, seconds that were cut off
};

/// Ends the take in `partial`, NAME.partial of `record` or of a recording of composites, whose take
/// may be in segments, and renames the folder to NAME. Nothing is replaced. Errors: kUsage for another name, one that is
/// taken, or a take that is still being written; kNotFound without a take in it; kData without a
/// whole frame; kIo.
Result<Repaired> repair(const std::filesystem::path& partial);

}  // namespace mixrig::take
