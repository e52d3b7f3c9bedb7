// SPDX-License-Identifier: Apache-2.0
#include "host/output/datagrams/datagram_sender.h"

#include <cerrno>
#include <charconv>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace mixrig::stream {

Result<DatagramSender> DatagramSender::open(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  const char* const end = address.data() + address.size();
  sockaddr_in to{};
  to.sin_family = AF_INET;
  int port = 0;
  std::string host = colon == std::string::npos ? "" : address.substr(0, colon);
  if (host == "localhost") host = "127.0.0.1";
  if (colon == std::string::npos ||
      std::from_chars(address.data() + colon + 1, end, port).ptr != end || port < 1 ||
      port > 65535 || ::inet_pton(AF_INET, host.c_str(), &to.sin_addr) != 1)
    return Error{ErrorCode::kUsage, "\"" + address +
                                        "\" is no address: give an IPv4 address and a port, such "
                                        "as 127.0.0.1:7420"};
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  DatagramSender sender(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (sender.fd_ < 0 ||
      ::connect(sender.fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
    return system_error(ErrorCode::kDevice, "UDP: cannot send to " + address, errno);
  return sender;
}

DatagramSender::DatagramSender(DatagramSender&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), sent_(other.sent_), dropped_(other.dropped_) {}
DatagramSender& DatagramSender::operator=(DatagramSender&& other) noexcept {
  std::swap(fd_, other.fd_);
  sent_ = other.sent_, dropped_ = other.dropped_;
  return *this;
}
DatagramSender::~DatagramSender() {
  if (fd_ >= 0) ::close(fd_);
}

/// Sends without waiting. If nobody listens, the next call reports it, and the one after that sends
/// again.
void DatagramSender::send(std::string_view text) {
  const ssize_t size = ::send(fd_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  ++(size == static_cast<ssize_t>(text.size()) ? sent_ : dropped_);
}

}  // namespace mixrig::stream
