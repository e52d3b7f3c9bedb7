// SPDX-License-Identifier: Apache-2.0
// Where a Matroska file that was cut off while it was written ends. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>

#include "hal/base/result.h"

namespace mixrig::take {

struct MatroskaEnd {
  int frames = 0;          ///< whole pictures
  std::int64_t bytes = 0;  ///< up to the end of the last whole element
};

/// Walks a file of one track from element to element. A file that is not there has no frame.
/// Errors: kIo.
Result<MatroskaEnd> find_matroska_end(const std::filesystem::path& path);

}  // namespace mixrig::take
