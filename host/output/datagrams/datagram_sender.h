// SPDX-License-Identifier: Apache-2.0
// Sends texts as UDP datagrams.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/base/result.h"

namespace mixrig::stream {

/// Never waits: a datagram that the system does not accept at once is dropped and counted. For one
/// thread.
class DatagramSender {
 public:
  /// `address`: "HOST:PORT", an IPv4 address or "localhost". Errors: kUsage, kDevice.
  static Result<DatagramSender> open(const std::string& address);
  DatagramSender(DatagramSender&& other) noexcept;
  DatagramSender& operator=(DatagramSender&& other) noexcept;
  ~DatagramSender();

  void send(std::string_view text);
  std::uint64_t sent() const { return sent_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  explicit DatagramSender(int fd) : fd_(fd) {}
  int fd_ = -1;
  std::uint64_t sent_ = 0, dropped_ = 0;
};

}  // namespace mixrig::stream
