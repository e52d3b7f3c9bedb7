// SPDX-License-Identifier: Apache-2.0
// `mixrig scan --merge`: joins rooms that were scanned from several positions.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/result.h"

namespace mixrig::tools {

struct ScanMergeOptions {
  std::vector<std::string> rooms;  ///< folders; the last one is OUT unless that is given
  std::string near;                ///< "x y z yaw" in metres and degrees; empty: none
};

/// Prints the result and returns it as JSON. Errors: kUsage; those of session::merge_rooms().
Result<nlohmann::json> scan_merge(const ScanMergeOptions& options, const std::string& out,
                                  int threads);

}  // namespace mixrig::tools
