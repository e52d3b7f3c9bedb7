// SPDX-License-Identifier: Apache-2.0
// The serial line of an emulated board: a pty behind a symbolic link, or a Unix socket.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace mixrig::sim {

/// One end of a line; the other end may come and go. Errors are told in `error()`.
class SimLine {
 public:
  /// A pty whose slave name is linked at `path`.
  static std::optional<SimLine> open_pty(const std::string& path, std::string& error);
  /// A listening socket at `path`; one client at a time.
  static std::optional<SimLine> open_socket(const std::string& path, std::string& error);
  ~SimLine();
  SimLine(SimLine&& other) noexcept;
  SimLine& operator=(SimLine&&) = delete;

  /// Waits for bytes, at most `timeout_us`. Returns how many came; 0 on time-out.
  std::size_t read(std::span<std::uint8_t> out, std::uint64_t timeout_us);
  /// Drops what nobody reads: a transmitter does not wait either.
  void write(std::span<const std::uint8_t> bytes);

 private:
  SimLine(std::string path, int listener, int fd, int keep_open)
      : path_(std::move(path)), listener_(listener), fd_(fd), keep_open_(keep_open) {}
  void hang_up();

  std::string path_;
  int listener_ = -1;  ///< socket only
  int fd_ = -1;
  int keep_open_ = -1;  ///< slave of the pty: keeps its settings, and reads from failing
};

}  // namespace mixrig::sim
