// SPDX-License-Identifier: Apache-2.0
// How well depth lies on the plate, without truth, for `mixrig info` and `mixrig diag`.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/capture/capture/capture_source.h"
#include "host/judge/measure/registration.h"

namespace mixrig::tools {

/// Measures the captures of these numbers; fewer where the source ends before. Errors: those of
/// reading and of the first compositor, such as a source without a plate.
Result<measure::Registration> registration_of(capture::CaptureSource& source,
                                              const std::vector<int>& numbers);
nlohmann::json registration_json(const measure::Registration& found);
/// One line without its end.
std::string registration_text(const measure::Registration& found);

}  // namespace mixrig::tools
