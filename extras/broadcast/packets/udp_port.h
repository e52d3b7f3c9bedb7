// SPDX-License-Identifier: Apache-2.0
// A port of this machine that several receivers of this process share. Private to this module.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

#include "extras/broadcast/packets/udp_receiver.h"

namespace mixrig::stream {

/// A socket whose datagrams are copied to the inbox of each receiver. Thread-safe.
class UdpPort {
 public:
  /// Opens the port, or returns the one that this process has open at the same address. Errors:
  /// those of UdpReceiver::open().
  static Result<std::shared_ptr<UdpPort>> at(const std::string& host, int port);
  ~UdpPort();
  UdpPort(const UdpPort&) = delete;
  UdpPort& operator=(const UdpPort&) = delete;

  /// Returns the descriptor of a new inbox, from which read_inbox() reads; -1 and errno on failure.
  int add_inbox();
  void remove_inbox(int inbox);
  /// Copies the datagrams that have come to all inboxes; one that is full loses them. False and
  /// errno where the socket fails.
  bool deliver();
  int fd() const { return fd_; }
  int number() const { return number_; }

 private:
  UdpPort(std::string host, int fd, int number);
  static Result<std::shared_ptr<UdpPort>> open(const std::string& host, int port);

  struct Inbox {
    int read, write;
  };
  const std::string host_;
  const int fd_, number_;
  std::mutex mutex_;  ///< guards what follows
  std::vector<Inbox> inboxes_;
  std::vector<std::byte> buffer_;
};

/// Reads one datagram of an inbox, without waiting. Returns its size, or -1 and errno.
ssize_t read_inbox(int inbox, Sender& from, std::span<std::byte> buffer);

}  // namespace mixrig::stream
