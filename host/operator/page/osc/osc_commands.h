// SPDX-License-Identifier: Apache-2.0
// Messages of OSC as actions, and the state as messages. Pure; docs/reference/page_api.md lists the
// addresses.
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

/// What a message asks for; nullopt: to be told the state alone ("/mixrig/state"). `state` as
/// to_json(): names in addresses are stream::osc_name() of those of the objects, lamps and cameras.
/// Errors: kNotFound for an address or a name that is not there; kUsage for arguments that are
/// missing, of another type, or out of range.
Result<std::optional<Action>> action_of(const stream::OscReceived& message,
                                        const nlohmann::json& state);

/// The state as datagrams, by their addresses.
std::map<std::string, std::string> osc_of(const nlohmann::json& state);

}  // namespace mixrig::page
