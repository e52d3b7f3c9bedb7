// SPDX-License-Identifier: Apache-2.0
// A two-way stream of bytes: a serial port, a pty, a socket, or a script of a test.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/clock.h"
#include "hal/base/result.h"

namespace mixrig::device {

enum class Parity { kNone, kEven };

/// How a serial line talks; 8 data bits, 1 stop bit always.
struct LineSettings {
  int baud = 115'200;
  Parity parity = Parity::kNone;
};

/// For one thread. Errors: kDevice when the other end is gone (unplugged, hung up).
class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// Reads what is there, at least one byte, waiting at most `timeout`; 0 bytes when none came.
  virtual Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) = 0;
  /// Writes all of it. Errors: kTimeout when the other end does not take it within a second.
  virtual Result<void> write(std::span<const std::uint8_t> bytes) = 0;
  /// Only real ports have a line to set; ptys and sockets carry bytes whatever it says.
  virtual Result<void> set_line(const LineSettings& /*settings*/) { return {}; }
};

}  // namespace mixrig::device
