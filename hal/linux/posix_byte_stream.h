// SPDX-License-Identifier: Apache-2.0
// Bytes over a file descriptor: terminals, ptys, sockets.
#pragma once

#include <memory>
#include <string>

#include "hal/device/byte_stream.h"

namespace mixrig::device {

class PosixByteStream final : public ByteStream {
 public:
  /// Opens a terminal device and sets it to raw mode. Errors: kNotFound, kIo.
  static Result<std::unique_ptr<ByteStream>> open_terminal(const std::string& path);
  /// Connects to a Unix socket. Errors: kNotFound, kIo.
  static Result<std::unique_ptr<ByteStream>> connect_unix(const std::string& path);
  /// Connects to `host_and_port`, HOST:PORT with an IPv6 address in brackets. Errors: kUsage,
  /// kNotFound, kIo; kTimeout if nothing answers for two seconds.
  static Result<std::unique_ptr<ByteStream>> connect_tcp(const std::string& host_and_port);
  /// Takes ownership of an open descriptor; `name` is for error lines.
  PosixByteStream(int fd, std::string name);
  ~PosixByteStream() override;
  PosixByteStream(const PosixByteStream&) = delete;
  PosixByteStream& operator=(const PosixByteStream&) = delete;

  Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) override;
  Result<void> write(std::span<const std::uint8_t> bytes) override;
  /// Sets what a terminal supports; sockets ignore it.
  Result<void> set_line(const LineSettings& settings) override;

 private:
  int fd_;
  bool is_socket_ = false;
  std::string name_;
};

}  // namespace mixrig::device
