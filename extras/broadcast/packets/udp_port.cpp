// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/udp_port.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

namespace mixrig::stream {
namespace {

constexpr std::size_t kLongestDatagram = 65536;
constexpr int kMostAtOnce = 256;  // datagrams of one deliver()

/// The ports that this process has open. A port belongs to the whole process, so this does too.
struct OpenPorts {
  std::mutex mutex;
  std::vector<std::weak_ptr<UdpPort>> ports;
};
OpenPorts& open_ports() {
  static OpenPorts ports;
  return ports;
}

/// Joins a multicast group, to which several programs may listen.
bool join(int fd, const in_addr& group) {
  const int yes = 1;
  ip_mreq request{};
  request.imr_multiaddr = group;
  return ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
         ::setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) == 0;
}

}  // namespace

UdpPort::UdpPort(std::string host, int fd, int number)
    : host_(std::move(host)), fd_(fd), number_(number), buffer_(kLongestDatagram) {}

UdpPort::~UdpPort() { ::close(fd_); }

Result<std::shared_ptr<UdpPort>> UdpPort::at(const std::string& host, int port) {
  OpenPorts& open_now = open_ports();
  const std::lock_guard lock(open_now.mutex);
  std::erase_if(open_now.ports, [](const auto& known) { return known.expired(); });
  std::string other;
  for (const auto& known : open_now.ports) {
    const auto there = known.lock();
    if (!there || there->number_ != port) continue;
    if (there->host_ == host) return there;
    other = there->host_ + ":" + std::to_string(port);
  }
  auto opened = open(host, port);
  if (opened)
    open_now.ports.push_back(*opened);
  else if (!other.empty())
    return Error{ErrorCode::kDevice,
                 opened.error().context + ": this run listens on " + other +
                     " already: name the same address in camera.pose and in lens.uri of rig.toml"};
  return opened;
}

Result<std::shared_ptr<UdpPort>> UdpPort::open(const std::string& host, int port) {
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::inet_pton(AF_INET, host.c_str(), &own.sin_addr) != 1)
    return Error{ErrorCode::kUsage, "\"" + host +
                                        "\" is no IPv4 address of this machine: give one, or "
                                        "0.0.0.0 for all"};
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return system_error(ErrorCode::kDevice, "no socket", errno);
  const auto failed = [fd](const std::string& what) {
    const int why = errno;
    ::close(fd);
    return system_error(ErrorCode::kDevice, what, why);
  };
  if (IN_MULTICAST(ntohl(own.sin_addr.s_addr)) && !join(fd, own.sin_addr))
    return failed("cannot join the group " + host);
  socklen_t size = sizeof own;
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0 ||
      ::getsockname(fd, reinterpret_cast<sockaddr*>(&own), &size) != 0)
    return failed("cannot listen on " + host + ":" + std::to_string(port));
  return std::shared_ptr<UdpPort>(new UdpPort(host, fd, ntohs(own.sin_port)));
}

int UdpPort::add_inbox() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return -1;
  const std::lock_guard lock(mutex_);
  inboxes_.push_back({ends[0], ends[1]});
  return ends[0];
}

void UdpPort::remove_inbox(int inbox) {
  const std::lock_guard lock(mutex_);
  std::erase_if(inboxes_, [inbox](const Inbox& known) {
    if (known.read != inbox) return false;
    ::close(known.read);
    ::close(known.write);
    return true;
  });
}

bool UdpPort::deliver() {
  const std::lock_guard lock(mutex_);
  for (int i = 0; i < kMostAtOnce; ++i) {
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t size = ::recvfrom(fd_, buffer_.data(), buffer_.size(), MSG_DONTWAIT,
                                    reinterpret_cast<sockaddr*>(&from), &length);
    if (size < 0) return errno == EAGAIN || errno == EINTR;
    Sender sender{ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)};
    std::array<iovec, 2> parts{
        {{&sender, sizeof sender}, {buffer_.data(), static_cast<std::size_t>(size)}}};
    msghdr message{};
    message.msg_iov = parts.data(), message.msg_iovlen = parts.size();
    for (const Inbox& inbox : inboxes_)
      (void)::sendmsg(inbox.write, &message, MSG_DONTWAIT | MSG_NOSIGNAL);
  }
  return true;
}

ssize_t read_inbox(int inbox, Sender& from, std::span<std::byte> buffer) {
  std::array<iovec, 2> parts{{{&from, sizeof from}, {buffer.data(), buffer.size()}}};
  msghdr message{};
  message.msg_iov = parts.data(), message.msg_iovlen = parts.size();
  const ssize_t size = ::recvmsg(inbox, &message, MSG_DONTWAIT);
  return size < 0 ? size : std::max<ssize_t>(0, size - static_cast<ssize_t>(sizeof from));
}

}  // namespace mixrig::stream
