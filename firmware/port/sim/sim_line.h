// SPDX-License-Identifier: Apache-2.0
// The serial line of an emulated board: a pty behind a symbolic link, or a Unix socket.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace mixrig::sim {

/// One end of a line; the other end may connect and disconnect.
class SimLine {
 public:
  /// A pty whose slave name is linked at `path`. Empty on failure, with the reason in `error`.
  static std::optional<SimLine> open_pty(const std::string& path, std::string& error);
  /// A listening socket at `path`; one client at a time. Empty on failure, with the reason in
  /// `error`.
  static std::optional<SimLine> open_socket(const std::string& path, std::string& error);
  ~SimLine();
  SimLine(SimLine&& other) noexcept;
  SimLine& operator=(SimLine&&) = delete;

  /// Waits at most `timeout_us` for bytes. Returns the count read; 0 on time-out.
  std::size_t read(std::span<std::uint8_t> out, std::uint64_t timeout_us);
  /// Never waits: like a UART's transmitter, it drops bytes that are not read.
  void write(std::span<const std::uint8_t> bytes);

 private:
  SimLine(std::string path, int listener, int fd, int keep_open)
      : path_(std::move(path)), listener_(listener), fd_(fd), keep_open_(keep_open) {}
  void hang_up();

  std::string path_;
  int listener_ = -1;  ///< socket only
  int fd_ = -1;
  int keep_open_ =
      -1;  ///< slave of the pty, held open so that settings persist and reads do not fail
};

}  // namespace mixrig::sim
