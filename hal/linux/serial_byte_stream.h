// SPDX-License-Identifier: Apache-2.0
// Bytes over a serial port, on libserialport.
#pragma once

#include <memory>
#include <string>

#include "hal/device/byte_stream.h"

struct sp_port;

namespace mixrig::device {

/// A real port; libserialport cannot open ptys (see PosixByteStream).
class SerialByteStream final : public ByteStream {
 public:
  /// Opens the port at 115,200 baud, no parity, no flow control. Errors: kNotFound, kIo.
  static Result<std::unique_ptr<ByteStream>> open(const std::string& path);
  ~SerialByteStream() override;
  SerialByteStream(const SerialByteStream&) = delete;
  SerialByteStream& operator=(const SerialByteStream&) = delete;

  Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  Result<void> set_line(const LineSettings& settings) override;

 private:
  SerialByteStream(sp_port* port, std::string name) : port_(port), name_(std::move(name)) {}

  sp_port* port_;
  std::string name_;
};

/// Opens a stream by its name: `unix:PATH` and `tcp:HOST:PORT` are sockets, the path of a pty uses
/// PosixByteStream, any other path is a serial port.
Result<std::unique_ptr<ByteStream>> open_byte_stream(const std::string& name);

}  // namespace mixrig::device
