// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/udp_receiver.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace mixrig::stream {
namespace {

bool parse_whole(std::string_view text, int least, int most, int& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  return fault == std::errc() && stop == end && value >= least && value <= most;
}

/// Joins a multicast group, to which several programs may listen.
bool join(int fd, const in_addr& group) {
  const int yes = 1;
  ip_mreq request{};
  request.imr_multiaddr = group;
  return ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
         ::setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) == 0;
}

/// "[HOST:]PORT[,NUMBER]"; nullopt for another text.
std::optional<ListenAddress> parse_listen_address(std::string_view text, int least_number,
                                                  int most_number) {
  ListenAddress address;
  if (const std::size_t comma = text.find(','); comma != std::string_view::npos) {
    int number = 0;
    if (!parse_whole(text.substr(comma + 1), least_number, most_number, number))
      return std::nullopt;
    address.number = number;
    text = text.substr(0, comma);
  }
  if (const std::size_t colon = text.rfind(':'); colon != std::string_view::npos) {
    address.host = text.substr(0, colon);
    text = text.substr(colon + 1);
  }
  in_addr host{};
  if (::inet_pton(AF_INET, address.host.c_str(), &host) != 1) return std::nullopt;
  if (!parse_whole(text, 1, 65535, address.port)) return std::nullopt;
  return address;
}

}  // namespace

Result<ListenAddress> parse_listen_uri(const std::string& uri, const ListenScheme& scheme) {
  const std::string start = std::string(scheme.scheme) + ":";
  const auto listen = uri.starts_with(start)
                          ? parse_listen_address(std::string_view(uri).substr(start.size()),
                                                 scheme.least_number, scheme.most_number)
                          : std::nullopt;
  if (listen) return *listen;
  return Error{ErrorCode::kUsage, "\"" + uri + "\" is no address of " + scheme.protocol + ": use " +
                                      start + "[HOST:]PORT[," + scheme.number + "]"};
}

Result<UdpReceiver> UdpReceiver::open(std::string protocol, const std::string& host, int port) {
  const auto failed = [&protocol](const std::string& what) {
    return system_error(ErrorCode::kDevice, protocol + ": " + what, errno);
  };
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, host.c_str(), &own.sin_addr) != 1)
    return Error{ErrorCode::kUsage, protocol + ": \"" + host +
                                        "\" is no IPv4 address of this machine: give one, or "
                                        "0.0.0.0 for all"};
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return failed("no socket");
  UdpReceiver receiver(protocol, fd, port);
  if (IN_MULTICAST(ntohl(own.sin_addr.s_addr)) && !join(fd, own.sin_addr))
    return failed("cannot join the group " + host);
  socklen_t size = sizeof own;
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0 ||
      ::getsockname(fd, reinterpret_cast<sockaddr*>(&own), &size) != 0)
    return failed("cannot listen on " + host + ":" + std::to_string(port));
  receiver.port_ = ntohs(own.sin_port);
  return receiver;
}

UdpReceiver::UdpReceiver(UdpReceiver&& other) noexcept
    : protocol_(std::move(other.protocol_)),
      fd_(std::exchange(other.fd_, -1)),
      port_(other.port_) {}
UdpReceiver& UdpReceiver::operator=(UdpReceiver&& other) noexcept {
  std::swap(protocol_, other.protocol_);
  std::swap(fd_, other.fd_);
  port_ = other.port_;
  return *this;
}
UdpReceiver::~UdpReceiver() {
  if (fd_ >= 0) ::close(fd_);
}

Result<std::optional<std::span<const std::byte>>> UdpReceiver::next(std::span<std::byte> buffer,
                                                                    Duration timeout) {
  using Datagram = std::optional<std::span<const std::byte>>;
  pollfd wait{fd_, POLLIN, 0};
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(std::max(timeout, Duration(0)));
  if (::poll(&wait, 1, static_cast<int>(ms.count())) < 0 && errno != EINTR)
    return system_error(ErrorCode::kDevice, protocol_ + ": waiting failed", errno);
  if (wait.revents == 0) return Datagram();
  const ssize_t size = ::recv(fd_, buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (size >= 0) return Datagram(buffer.first(static_cast<std::size_t>(size)));
  if (errno == EAGAIN || errno == EINTR) return Datagram();
  return system_error(ErrorCode::kDevice, protocol_ + ": reading failed", errno);
}

}  // namespace mixrig::stream
