// SPDX-License-Identifier: Apache-2.0
// A motion capture server on the loopback that sends packets when its user says so.
// tests/unit/mocap/natnet_packets.h writes them, independently of the receiver.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/unit/mocap/natnet_packets.h"

namespace mixrig::test {

/// Not thread-safe. A socket that cannot be opened or bound ends the program.
class NatNetSender {
 public:
  explicit NatNetSender(int port = 0) {
    sockaddr_in own = loopback(port);
    socklen_t size = sizeof own;
    if (::bind(fd_, reinterpret_cast<const sockaddr*>(&own), size) != 0) std::abort();
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&own), &size);
    port_ = ntohs(own.sin_port);
  }
  ~NatNetSender() {
    ::close(fd_);
    ::close(other_fd_);
  }
  NatNetSender(const NatNetSender&) = delete;
  NatNetSender& operator=(const NatNetSender&) = delete;

  int port() const { return port_; }
  /// Reads a client's packet that arrives within `timeout_ms`, and answers a connect packet with
  /// the server's name, version 3.0, clock rate and port. Returns whether a client is known.
  bool has_client(int timeout_ms) {
    pollfd wait{fd_, POLLIN, 0};
    if (::poll(&wait, 1, timeout_ms) <= 0) return known_;
    unsigned char bytes[512];
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got =
        ::recvfrom(fd_, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 4 || bytes[0] != 0 || bytes[1] != 0) return known_;
    client_ = from;
    known_ = true;
    send(server_info());
    return true;
  }
  void send(std::span<const std::byte> packet) const { send_by(fd_, packet); }
  /// Sends from another port, like a second server on this machine.
  void send_from_elsewhere(std::span<const std::byte> packet) const { send_by(other_fd_, packet); }

 private:
  static sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }
  static std::vector<std::byte> server_info() {
    std::vector<std::byte> name = stream::PacketWriter().text("Motive").bytes();
    name.resize(256 + 4);
    stream::PacketWriter info;
    for (const std::byte b : name) info.put(b);
    for (const int part : {3, 0, 0, 0}) info.put(static_cast<std::uint8_t>(part));
    info.put(std::uint64_t{1'000'000}).put(std::uint16_t{1511});     // ticks a second, data port
    for (int byte = 0; byte < 5; ++byte) info.put(std::uint8_t{0});  // no multicast
    return info.packet(1);
  }
  void send_by(int fd, std::span<const std::byte> packet) const {
    (void)::sendto(fd, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&client_),
                   sizeof client_);
  }

  int fd_ = ::socket(AF_INET, SOCK_DGRAM, 0), other_fd_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  int port_ = 0;
  bool known_ = false;
  sockaddr_in client_{};
};

}  // namespace mixrig::test
