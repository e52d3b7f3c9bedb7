// SPDX-License-Identifier: Apache-2.0
// Open Sound Control 1.0, read: what control surfaces send. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::stream {

/// Integers and floats are numbers; T and F are booleans.
using OscArgument = std::variant<double, bool, std::string>;

struct OscReceived {
  std::string address;
  std::vector<OscArgument> arguments;
};

/// The messages of a datagram: one, or those of a bundle, whose time tag is ignored: everything is
/// of now. At most 32 messages, 16 arguments each, bundles 4 deep. Types i, f, s, h, d, T, F; N and
/// I are left out. Errors: kFormat, one line.
Result<std::vector<OscReceived>> parse_osc(std::span<const std::uint8_t> datagram);

}  // namespace mixrig::stream
