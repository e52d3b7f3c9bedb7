// SPDX-License-Identifier: Apache-2.0
// mixrig scan --merge: rooms scanned from several positions become one.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/result.h"

namespace mixrig::tools {

struct ScanMergeOptions {
  std::vector<std::string> rooms;  ///< and last OUT, where that is not given for itself
  std::string near;                ///< "x y z yaw" in metres and degrees; empty: none
};

/// Prints what was found and returns it as JSON. Errors: kUsage; those of session::merge_rooms().
Result<nlohmann::json> scan_merge(const ScanMergeOptions& options, const std::string& out,
                                  int threads);

}  // namespace mixrig::tools
