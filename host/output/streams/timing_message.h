// SPDX-License-Identifier: Apache-2.0
// Mends the picture timing messages that h264parse writes into H.264.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace mixrig::output {

/// Takes away, in place, what follows the end of the messages before the first slice of an access
/// unit, and messages without an end: h264parse of GStreamer 1.22 leaves bytes behind its own
/// messages, which decoders take for another one, and takes the end of the encoder's.
/// `unit` is a byte stream with start codes. Returns the bytes that are left. Pure; any bytes.
std::size_t end_messages(std::span<std::uint8_t> unit);

}  // namespace mixrig::output
