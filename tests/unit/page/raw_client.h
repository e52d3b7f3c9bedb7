// SPDX-License-Identifier: Apache-2.0
// A client that sends any bytes to a port of this machine; it shares no code with the server.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace mixrig::page {

class RawClient {
 public:
  /// `receive_bytes`: size of the receive buffer; a small one fills up while the client does not
  /// read. 0: the default.
  /// `from`: the client's own address, in host order.
  explicit RawClient(std::uint16_t port, int receive_bytes = 0,
                     std::uint32_t from = INADDR_LOOPBACK) {
    socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (receive_bytes > 0)
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof(receive_bytes));
    const timeval limit{60, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(from);
    if (from != INADDR_LOOPBACK) {
      sockaddr_in own = address;
      own.sin_port = 0;
      ::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof(own));
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    }
    connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  ~RawClient() { close(); }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

  bool send(const std::string& bytes) {
    std::size_t done = 0;
    while (connected_ && done < bytes.size()) {
      const ssize_t n = ::send(socket_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      if (n <= 0) return false;
      done += static_cast<std::size_t>(n);
    }
    return connected_;
  }
  /// Reads up to and including `end`; bytes beyond it are kept for later. Empty when the other side
  /// closed.
  std::string read_to(const std::string& end) {
    while (read_.find(end) == std::string::npos)
      if (!more()) return {};
    return take(read_.find(end) + end.size());
  }
  std::string read_bytes(std::size_t count) {
    while (read_.size() < count)
      if (!more()) return {};
    return take(count);
  }
  std::string read_all() {
    while (more()) {
    }
    return take(read_.size());
  }

  struct Response {
    int status = 0;
    std::string head, body;
    std::string field(const std::string& name) const {
      const std::size_t at = head.find("\r\n" + name + ": ");
      if (at == std::string::npos) return {};
      const std::size_t from = at + name.size() + 4;
      return head.substr(from, head.find("\r\n", from) - from);
    }
  };
  Response response() {
    Response response;
    response.head = read_to("\r\n\r\n");
    if (response.head.size() > 12) response.status = std::stoi(response.head.substr(9, 3));
    const std::string length = response.field("Content-Length");
    if (!length.empty()) response.body = read_bytes(std::stoul(length));
    return response;
  }

  /// Sends a masked text message of less than 65536 bytes (RFC 6455).
  bool send_message(const std::string& text) {
    std::string frame = "\x81";
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += static_cast<char>(0x80 | 126);
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size() & 255);
    }
    const std::array<char, 4> mask{1, 2, 3, 4};
    frame.append(mask.data(), 4);
    for (std::size_t i = 0; i < text.size(); ++i) frame += static_cast<char>(text[i] ^ mask[i % 4]);
    return send(frame);
  }
  /// Reads the next text message; empty when the socket was closed.
  std::string message() {
    for (;;) {
      const std::string head = read_bytes(2);
      if (head.size() < 2) return {};
      std::size_t length = static_cast<unsigned char>(head[1]) & 127;
      if (length >= 126) {
        std::size_t extended = 0;
        for (const char c : read_bytes(length == 126 ? 2 : 8))
          extended = extended << 8 | static_cast<unsigned char>(c);
        length = extended;
      }
      std::string text = read_bytes(length);
      const int kind = head[0] & 15;
      if (kind == 1) return text;
      if (kind == 8) return {};
    }
  }

 private:
  bool more() {
    std::array<char, 65536> bytes;
    const ssize_t n = ::recv(socket_, bytes.data(), bytes.size(), 0);
    if (n <= 0) return false;
    read_.append(bytes.data(), static_cast<std::size_t>(n));
    return true;
  }
  std::string take(std::size_t count) {
    std::string taken = read_.substr(0, count);
    read_.erase(0, count);
    return taken;
  }

  int socket_ = -1;
  bool connected_ = false;
  std::string read_;
};

}  // namespace mixrig::page
