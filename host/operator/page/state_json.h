// SPDX-License-Identifier: Apache-2.0
// The state of a run as JSON: an object of parts, each of which can be subscribed to. Pure.
#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

#include "host/operator/page/operator.h"
#include "host/output/sink/views.h"

namespace mixrig::page {

/// Shown view, whether it is frozen, and the number of clients.
using output::View;
struct PageState {
  View view = View::kComposite;
  bool frozen = false;
  int clients = 0;
};

/// State as an object with the keys "run", "picture", "pose", "recording", "background", "scan",
/// "sweep", "focus", "disk", "calibration", "streams", "cameras", "objects", "lamps", "log",
/// "view", "freeze", "clients" (docs/reference/page_openapi.yaml). Numbers are rounded, so that
/// noise does not count as a change.
nlohmann::json to_json(const State& state, const PageState& page);

/// Whether it is a key of to_json().
bool is_part(std::string_view name);
const std::vector<std::string_view>& parts();

}  // namespace mixrig::page
