// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/udp_receiver.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <poll.h>

#include "extras/broadcast/packets/udp_port.h"

namespace mixrig::stream {
namespace {

bool parse_whole(std::string_view text, int least, int most, int& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  return fault == std::errc() && stop == end && value >= least && value <= most;
}

/// "[HOST:]PORT[,NUMBER][@SENDER]"; nullopt for another text.
std::optional<ListenAddress> parse_listen_address(std::string_view text, int least_number,
                                                  int most_number) {
  ListenAddress address;
  if (const std::size_t at = text.find('@'); at != std::string_view::npos) {
    in_addr sender{};
    if (::inet_pton(AF_INET, std::string(text.substr(at + 1)).c_str(), &sender) != 1)
      return std::nullopt;
    address.sender = ntohl(sender.s_addr);
    text = text.substr(0, at);
  }
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
                                      start + "[HOST:]PORT[," + scheme.number +
                                      "][@SENDER], HOST and SENDER as IPv4"};
}

std::string address_text(std::uint32_t address) {
  return fmt::format("{}.{}.{}.{}", address >> 24, address >> 16 & 255, address >> 8 & 255,
                     address & 255);
}

Result<UdpReceiver> UdpReceiver::open(std::string protocol, const std::string& host, int port) {
  auto shared = UdpPort::at(host, port);
  if (!shared) {
    const Error& why = shared.error();
    return Error{why.code, protocol + ": " + why.context, why.sys_errno};
  }
  const int inbox = (*shared)->add_inbox();
  if (inbox < 0) return system_error(ErrorCode::kDevice, protocol + ": no socket", errno);
  return UdpReceiver(std::move(protocol), *std::move(shared), inbox);
}

UdpReceiver::UdpReceiver(UdpReceiver&& other) noexcept
    : protocol_(std::move(other.protocol_)),
      port_(std::move(other.port_)),
      inbox_(std::exchange(other.inbox_, -1)) {}
UdpReceiver& UdpReceiver::operator=(UdpReceiver&& other) noexcept {
  std::swap(protocol_, other.protocol_);
  std::swap(port_, other.port_);
  std::swap(inbox_, other.inbox_);
  return *this;
}
UdpReceiver::~UdpReceiver() {
  if (port_) port_->remove_inbox(inbox_);
}

int UdpReceiver::port() const { return port_->number(); }

Result<std::optional<Datagram>> UdpReceiver::next(std::span<std::byte> buffer, Duration timeout) {
  std::array<pollfd, 2> wait{{{inbox_, POLLIN, 0}, {port_->fd(), POLLIN, 0}}};
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(std::max(timeout, Duration(0)));
  if (::poll(wait.data(), wait.size(), static_cast<int>(ms.count())) < 0 && errno != EINTR)
    return system_error(ErrorCode::kDevice, protocol_ + ": waiting failed", errno);
  if (wait[1].revents != 0 && !port_->deliver())
    return system_error(ErrorCode::kDevice, protocol_ + ": reading failed", errno);
  Datagram datagram;
  const ssize_t size = read_inbox(inbox_, datagram.from, buffer);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return std::optional<Datagram>();
  if (size < 0) return system_error(ErrorCode::kDevice, protocol_ + ": reading failed", errno);
  datagram.bytes = buffer.first(static_cast<std::size_t>(size));
  return std::optional(datagram);
}

}  // namespace mixrig::stream
