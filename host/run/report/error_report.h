// SPDX-License-Identifier: Apache-2.0
// Errors against truth, as JSON and as a table for people.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/judge/baselines/baselines.h"

namespace mixrig::session {

/// `value` with so many digits.
double rounded(double value, int digits = 4);
/// null where there is none, else rounded.
nlohmann::json or_null(const std::optional<double>& value);

/// `error` of a report: an error measure without a pixel to judge becomes null.
/// docs/reference/measures.md defines the keys.
nlohmann::json to_json(const measure::Errors& errors);
/// A row for each measure; a column for the run, then one for each plain composite beside it.
std::string error_table(const measure::Errors& errors,
                        const std::vector<BaselineErrors>& baselines);

}  // namespace mixrig::session
