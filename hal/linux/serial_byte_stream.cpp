// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/serial_byte_stream.h"

#include <cerrno>
#include <filesystem>
#include <string_view>
#include <utility>

#include <libserialport.h>

#include "hal/linux/posix_byte_stream.h"

namespace mixrig::device {

namespace {

constexpr unsigned kSerialWriteTimeoutMs = 1000;

Error serial_error(ErrorCode code, const std::string& what, sp_return status) {
  return system_error(code, what, status == SP_ERR_FAIL ? sp_last_error_code() : 0);
}

}  // namespace

Result<std::unique_ptr<ByteStream>> SerialByteStream::open(const std::string& path) {
  sp_port* port = nullptr;
  sp_return status = sp_get_port_by_name(path.c_str(), &port);
  if (status != SP_OK) {
    return serial_error(ErrorCode::kNotFound, "no serial port " + path + ": is it plugged in?",
                        status);
  }
  std::unique_ptr<SerialByteStream> stream(new SerialByteStream(port, path));
  status = sp_open(port, SP_MODE_READ_WRITE);
  if (status != SP_OK) {
    const int cause = status == SP_ERR_FAIL ? sp_last_error_code() : 0;
    const char* hint = cause == EACCES ? ": add yourself to group dialout" : "";
    return system_error(ErrorCode::kIo, "cannot open " + path + hint, cause);
  }
  sp_set_flowcontrol(port, SP_FLOWCONTROL_NONE);
  MIXRIG_TRY(stream->set_line({}));
  sp_flush(port, SP_BUF_INPUT);
  return std::unique_ptr<ByteStream>(std::move(stream));
}

SerialByteStream::~SerialByteStream() {
  sp_close(port_);
  sp_free_port(port_);
}

Result<std::size_t> SerialByteStream::read(std::span<std::uint8_t> out, Duration timeout) {
  // libserialport waits forever with a time-out of 0.
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  const sp_return n =
      ms <= 0 ? sp_nonblocking_read(port_, out.data(), out.size())
              : sp_blocking_read_next(port_, out.data(), out.size(), static_cast<unsigned>(ms));
  if (n < 0) return serial_error(ErrorCode::kDevice, "lost " + name_ + ": unplugged?", n);
  return static_cast<std::size_t>(n);
}

Result<void> SerialByteStream::write(std::span<const std::uint8_t> bytes) {
  const sp_return n = sp_blocking_write(port_, bytes.data(), bytes.size(), kSerialWriteTimeoutMs);
  if (n < 0) return serial_error(ErrorCode::kDevice, "lost " + name_ + ": unplugged?", n);
  if (static_cast<std::size_t>(n) != bytes.size()) {
    return Error{ErrorCode::kTimeout, name_ + " accepts no bytes: does it hang?"};
  }
  return {};
}

Result<void> SerialByteStream::set_line(const LineSettings& settings) {
  sp_drain(port_);
  const sp_parity parity = settings.parity == Parity::kEven ? SP_PARITY_EVEN : SP_PARITY_NONE;
  sp_return status = sp_set_baudrate(port_, settings.baud);
  if (status == SP_OK) status = sp_set_bits(port_, 8);
  if (status == SP_OK) status = sp_set_parity(port_, parity);
  if (status == SP_OK) status = sp_set_stopbits(port_, 1);
  if (status == SP_OK) return {};
  return serial_error(ErrorCode::kIo, "cannot set up " + name_, status);
}

Result<std::unique_ptr<ByteStream>> open_byte_stream(const std::string& name) {
  constexpr std::string_view kUnix = "unix:";
  if (name.starts_with(kUnix)) return PosixByteStream::connect_unix(name.substr(kUnix.size()));
  constexpr std::string_view kTcp = "tcp:";
  if (name.starts_with(kTcp)) return PosixByteStream::connect_tcp(name.substr(kTcp.size()));
  std::error_code ignored;
  const std::string target = std::filesystem::canonical(name, ignored).string();
  if (target.starts_with("/dev/pts/")) return PosixByteStream::open_terminal(name);
  return SerialByteStream::open(name);
}

}  // namespace mixrig::device
