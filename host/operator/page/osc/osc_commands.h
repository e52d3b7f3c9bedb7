// SPDX-License-Identifier: Apache-2.0
// Converts OSC messages to actions, and the state to OSC messages. Pure; docs/reference/page_api.md
// lists the addresses.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/output/datagrams/osc_reader.h"
#include "hal/base/result.h"
#include "host/operator/page/route.h"

namespace mixrig::page {

/// Action of a message; nullopt: it asks for the state only ("/mixrig/state"). `state`: as from
/// to_json(); names in addresses are stream::osc_name() of the names of objects, lamps and cameras.
/// Errors: kNotFound for an unknown address or name; kUsage for arguments that are missing, of
/// another type, or out of range.
Result<std::optional<Action>> action_of(const stream::OscReceived& message,
                                        const nlohmann::json& state);

/// Datagrams of the state, by their addresses.
std::map<std::string, std::string> osc_of(const nlohmann::json& state);

}  // namespace mixrig::page
