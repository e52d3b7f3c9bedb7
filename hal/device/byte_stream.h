// SPDX-License-Identifier: Apache-2.0
// A two-way stream of bytes: a serial port, a pty, a socket, or a script in a test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::device {

enum class Parity { kNone, kEven };

/// Settings of a serial line; always 8 data bits and 1 stop bit.
struct LineSettings {
  int baud = 115'200;
  Parity parity = Parity::kNone;
};

/// A two-way byte stream. For one thread. Errors: kDevice when the other end is gone (unplugged,
/// hung up).
class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// Reads the bytes that have arrived; waits at most `timeout` for the first one. 0 when none
  /// arrived.
  virtual Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) = 0;
  /// Writes all bytes. Errors: kTimeout when the other end does not accept them within a second.
  virtual Result<void> write(std::span<const std::uint8_t> bytes) = 0;
  /// Only serial ports have these settings; ptys and sockets ignore them.
  virtual Result<void> set_line(const LineSettings& /*settings*/) { return {}; }
};

}  // namespace mixrig::device
