// SPDX-License-Identifier: Apache-2.0
// Ends long rendering between two pictures.
#pragma once

#include <atomic>

#include <fmt/format.h>

#include "hal/base/result.h"

namespace mixrig::studio_io {

/// Error: kData where it is to stop (null: never) and not all pictures are done.
inline Result<void> check_stop(const std::atomic<bool>* stop, int done, int all) {
  if (stop == nullptr || !*stop || done >= all) return {};
  return Error{ErrorCode::kData,
               fmt::format("stopped after {} of {} pictures: nothing was written", done, all)};
}

}  // namespace mixrig::studio_io
