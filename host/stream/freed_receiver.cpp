// SPDX-License-Identifier: Apache-2.0
#include "host/stream/freed_receiver.h"

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

Error freed_error(const std::string& what) {
  return system_error(ErrorCode::kDevice, "FreeD: " + what, errno);
}

bool parse_whole(std::string_view text, int least, int most, int& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  return fault == std::errc() && stop == end && value >= least && value <= most;
}

}  // namespace

Result<FreeDAddress> parse_freed_address(const std::string& uri) {
  const Error wrong{ErrorCode::kUsage,
                    "\"" + uri + "\" is no address of FreeD: use freed:[HOST:]PORT[,CAMERA]"};
  constexpr std::string_view kScheme = "freed:";
  if (!uri.starts_with(kScheme)) return wrong;
  std::string_view rest = std::string_view(uri).substr(kScheme.size());
  FreeDAddress address;
  if (const std::size_t comma = rest.find(','); comma != std::string_view::npos) {
    int camera = 0;
    if (!parse_whole(rest.substr(comma + 1), 0, 255, camera)) return wrong;
    address.camera = camera;
    rest = rest.substr(0, comma);
  }
  if (const std::size_t colon = rest.rfind(':'); colon != std::string_view::npos) {
    address.host = rest.substr(0, colon);
    rest = rest.substr(colon + 1);
  }
  in_addr host{};
  if (::inet_pton(AF_INET, address.host.c_str(), &host) != 1) return wrong;
  if (!parse_whole(rest, 1, 65535, address.port)) return wrong;
  return address;
}

Result<FreeDReceiver> FreeDReceiver::open(const FreeDAddress& address) {
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(static_cast<std::uint16_t>(address.port));
  if (::inet_pton(AF_INET, address.host.c_str(), &own.sin_addr) != 1)
    return Error{ErrorCode::kUsage, "FreeD: \"" + address.host +
                                        "\" is no IPv4 address of this machine: give one, or "
                                        "0.0.0.0 for all"};
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return freed_error("no socket");
  FreeDReceiver receiver(fd, address.port, address.camera);
  socklen_t size = sizeof own;
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0 ||
      ::getsockname(fd, reinterpret_cast<sockaddr*>(&own), &size) != 0)
    return freed_error("cannot listen on " + address.host + ":" + std::to_string(address.port));
  receiver.port_ = ntohs(own.sin_port);
  return receiver;
}

FreeDReceiver::FreeDReceiver(FreeDReceiver&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      port_(other.port_),
      camera_(other.camera_),
      counts_(other.counts_) {}
FreeDReceiver& FreeDReceiver::operator=(FreeDReceiver&& other) noexcept {
  std::swap(fd_, other.fd_);
  port_ = other.port_, camera_ = other.camera_, counts_ = other.counts_;
  return *this;
}
FreeDReceiver::~FreeDReceiver() {
  if (fd_ >= 0) ::close(fd_);
}

Result<std::optional<FreeDPacket>> FreeDReceiver::next(Duration timeout) {
  pollfd wait{fd_, POLLIN, 0};
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(std::max(timeout, Duration(0)));
  if (::poll(&wait, 1, static_cast<int>(ms.count())) < 0 && errno != EINTR)
    return freed_error("waiting failed");
  if (wait.revents == 0) return std::optional<FreeDPacket>();
  std::array<std::byte, kFreeDBytes + 1> buffer;  // one more tells a longer datagram
  const ssize_t size = ::recv(fd_, buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (size < 0) {
    if (errno == EAGAIN || errno == EINTR) return std::optional<FreeDPacket>();
    return freed_error("reading failed");
  }
  const auto packet = parse_freed({buffer.data(), static_cast<std::size_t>(size)});
  if (!packet) {
    ++counts_.malformed;
    return std::optional<FreeDPacket>();
  }
  if (camera_ && packet->camera != *camera_) {
    ++counts_.foreign;
    return std::optional<FreeDPacket>();
  }
  ++counts_.packets;
  return std::optional(*packet);
}

}  // namespace mixrig::stream
