// SPDX-License-Identifier: Apache-2.0
// A motion-capture server on the loopback, independent of the receiver: it waits for the client's
// connect packet and sends a test's datagrams, in its own thread.
#pragma once

#include <atomic>
#include <optional>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/unit/mocap/natnet_packets.h"

namespace mixrig::stream {

class NatNetServer {
 public:
  using Datagram = std::vector<std::byte>;

  /// Sends `datagrams` once, to the first client that connects, or to `group` (on its own port).
  explicit NatNetServer(std::vector<Datagram> datagrams, bool to_group = false)
      : datagrams_(std::move(datagrams)) {
    EXPECT_EQ(::bind(fd_, as_address(loopback(0)), sizeof(sockaddr_in)), 0);
    sockaddr_in own{};
    socklen_t size = sizeof own;
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&own), &size);
    port_ = ntohs(own.sin_port);
    if (to_group) {
      in_addr lo{htonl(INADDR_LOOPBACK)};
      ::setsockopt(fd_, IPPROTO_IP, IP_MULTICAST_IF, &lo, sizeof lo);
      group_ = loopback(port_);
      ::inet_pton(AF_INET, kGroup, &group_->sin_addr);
    }
    thread_ = std::thread([this] { serve(); });
  }
  ~NatNetServer() {
    stop_ = true;
    thread_.join();
    ::close(fd_);
  }
  NatNetServer(const NatNetServer&) = delete;
  NatNetServer& operator=(const NatNetServer&) = delete;

  static constexpr const char* kGroup = "239.255.42.99";
  int port() const { return port_; }  ///< port of commands, and of the group's data

 private:
  static sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }
  static const sockaddr* as_address(const sockaddr_in& address) {
    return reinterpret_cast<const sockaddr*>(&address);
  }
  /// True once a client has sent a connect packet: kind 0, 264 bytes.
  bool connected(sockaddr_in& client) {
    pollfd wait{fd_, POLLIN, 0};
    if (::poll(&wait, 1, 20) <= 0) return false;
    unsigned char bytes[512];
    socklen_t size = sizeof client;
    const ssize_t got =
        ::recvfrom(fd_, bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&client), &size);
    return got == 268 && bytes[0] == 0 && bytes[1] == 0 && bytes[2] == 8 && bytes[3] == 1;
  }
  void serve() {
    sockaddr_in client{};
    while (!connected(client))
      if (stop_) return;
    Datagram info = PacketWriter().text("Motive").bytes();
    info.resize(256 + 4);
    for (int part : {3, 0, 0, 0}) info.push_back(static_cast<std::byte>(part));
    PacketWriter server_info;
    for (std::byte b : info) server_info.put(b);
    send(server_info.packet(1), client);
    for (const Datagram& datagram : datagrams_) {
      if (stop_) return;
      send(datagram, group_.value_or(client));
      // Slow enough for a small socket buffer; nothing depends on how slow.
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }
  void send(const Datagram& datagram, const sockaddr_in& to) const {
    (void)::sendto(fd_, datagram.data(), datagram.size(), 0, as_address(to), sizeof to);
  }

  std::vector<Datagram> datagrams_;
  int fd_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  int port_ = 0;
  std::optional<sockaddr_in> group_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace mixrig::stream
