// SPDX-License-Identifier: Apache-2.0
// Parses Open Sound Control 1.0, as control surfaces send it. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::stream {

/// An argument: integers and floats are double; T and F are bool.
using OscArgument = std::variant<double, bool, std::string>;

struct OscReceived {
  std::string address;
  std::vector<OscArgument> arguments;
};

/// Parses a message, or the messages of a bundle, whose time tag is ignored. At most 32 messages,
/// 16 arguments each, bundles nested 4 deep. Types i, f, s, h, d, T, F; N and I are skipped.
/// Errors: kFormat, one line.
Result<std::vector<OscReceived>> parse_osc(std::span<const std::uint8_t> datagram);

}  // namespace mixrig::stream
