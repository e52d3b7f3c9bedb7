// SPDX-License-Identifier: Apache-2.0
// Report of `mixrig calibrate intrinsics` about a camera.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/calibrate/intrinsics/uncertainty.h"
#include "host/tools/calibrate/board_views.h"

namespace mixrig::tools {

/// Reasons why the points do not determine this lens, or do not fit it.
std::vector<std::string> fit_objections(const calibration::Intrinsics& in,
                                        const calibration::UncertaintyMap& map);
/// Reasons not to use this calibration, fit_objections() first; empty: go.
std::vector<std::string> objections(const calibration::Intrinsics& in,
                                    const calibration::UncertaintyMap& map);

nlohmann::json report_of(const std::string& camera, const BoardViews& all,
                         const calibration::Intrinsics& in, const calibration::UncertaintyMap& map,
                         const calibration::Advice& advice, const std::vector<std::string>& why);

/// Prints the figures of report_of() to stdout.
void print(const std::string& camera, const BoardViews& all, const calibration::Intrinsics& in,
           const calibration::UncertaintyMap& map, const calibration::Advice& advice,
           const std::vector<std::string>& why);

}  // namespace mixrig::tools
