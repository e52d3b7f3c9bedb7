// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/natnet_receiver.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <utility>

#include <arpa/inet.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/base/log.h"

namespace mixrig::stream {
namespace {

constexpr std::size_t kMostBytes = 65536;  // largest datagram
constexpr Duration kRequestEvery = std::chrono::seconds(1);
constexpr int kRestart = 1000;  // numbers this far back: the server restarted
// After so many frames in a row with rising numbers below the last one the server restarted.
constexpr int kBackRun = 5;
// More frames than this cannot have been sent since the last one: the server restarted.
constexpr double kMostRate_hz = 2000;
constexpr int kMostAtOnce = 16;
constexpr Duration kServerGone = std::chrono::seconds(2);  // without a frame

Error socket_error(const std::string& what) {
  return system_error(ErrorCode::kDevice, "motion capture: " + what, errno);
}

/// Splits "HOST" or "HOST:PORT".
bool split_port(const std::string& text, std::string& host, int& port) {
  const std::size_t colon = text.find(':');
  host = text.substr(0, colon);
  if (colon == std::string::npos) return !host.empty();
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + colon + 1, end, port);
  return !host.empty() && parsed.ec == std::errc{} && parsed.ptr == end && port >= 1 &&
         port <= 65535;
}

Result<sockaddr_in> look_up(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int code = ::getaddrinfo(host.c_str(), nullptr, &hints, &found); code != 0)
    return Error{ErrorCode::kNotFound, "motion capture: " + host + ": " + ::gai_strerror(code) +
                                           ": give the address of the machine that runs it"};
  sockaddr_in address = *reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  ::freeaddrinfo(found);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

bool is_loopback(const sockaddr_in& address) { return ntohl(address.sin_addr.s_addr) >> 24 == 127; }

/// Returns the first packet of a client: its name and version; the server answers with its own.
constexpr std::array<std::byte, 268> connect_packet() {
  std::array<std::byte, 268> packet{};  // kind 0
  packet[2] = std::byte{264 & 255};
  packet[3] = std::byte{264 >> 8};
  constexpr char kName[] = "mixrig";
  for (std::size_t i = 0; i + 1 < sizeof kName; ++i)
    packet[4 + i] = static_cast<std::byte>(kName[i]);
  packet[264] = std::byte{3};  // NatNet 3.0
  return packet;
}

}  // namespace

Result<NatNetAddress> parse_natnet_address(const std::string& uri) {
  const Error wrong{ErrorCode::kUsage, "\"" + uri +
                                           "\" is no address of a motion capture: use natnet, "
                                           "natnet:HOST[:PORT] or natnet:HOST,GROUP"};
  NatNetAddress address;
  if (!uri.starts_with("natnet")) return wrong;
  std::string rest = uri.substr(6);
  const std::size_t comma = rest.find(',');
  if (comma != std::string::npos &&
      !split_port(rest.substr(comma + 1), address.group, address.data_port))
    return wrong;
  rest = rest.substr(0, comma);
  if (rest.empty() || rest == ":") return address;
  if (rest[0] != ':' || !split_port(rest.substr(1), address.host, address.command_port))
    return wrong;
  return address;
}

NatNetReceiver::Socket::Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
NatNetReceiver::Socket& NatNetReceiver::Socket::operator=(Socket&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}
NatNetReceiver::Socket::~Socket() {
  if (fd_ >= 0) ::close(fd_);
}

NatNetReceiver::NatNetReceiver(sockaddr_in server, std::vector<Socket> sockets,
                               NatNetVersion version, const Clock& clock)
    : server_(server),
      sockets_(std::move(sockets)),
      version_(version),
      clock_(&clock),
      buffer_(kMostBytes) {}

/// Opens the socket for commands, bound to the loopback interface if the server is local, so that
/// no other machine reaches it.
Result<NatNetReceiver::Socket> NatNetReceiver::open_command(const sockaddr_in& server) {
  Socket socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (socket.fd() < 0) return socket_error("no socket");
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(is_loopback(server) ? INADDR_LOOPBACK : INADDR_ANY);
  if (::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
    return socket_error("no port for its answers");
  return socket;
}

Result<NatNetReceiver::Socket> NatNetReceiver::open_group(const NatNetAddress& address,
                                                          const sockaddr_in& server) {
  MIXRIG_ASSIGN(sockaddr_in group, look_up(address.group, address.data_port));
  Socket socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (socket.fd() < 0) return socket_error("no socket");
  const int yes = 1;
  ::setsockopt(socket.fd(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0)
    return socket_error("cannot listen on " + address.group);
  ip_mreq membership{};
  membership.imr_multiaddr = group.sin_addr;
  membership.imr_interface.s_addr = htonl(is_loopback(server) ? INADDR_LOOPBACK : INADDR_ANY);
  if (::setsockopt(socket.fd(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) != 0)
    return socket_error("cannot join the group " + address.group);
  return socket;
}

Result<NatNetReceiver> NatNetReceiver::open(const NatNetAddress& address, NatNetVersion version,
                                            const Clock& clock) {
  MIXRIG_ASSIGN(const sockaddr_in server, look_up(address.host, address.command_port));
  std::vector<Socket> sockets;
  MIXRIG_ASSIGN(Socket command, open_command(server));
  sockets.push_back(std::move(command));
  if (!address.group.empty()) {
    MIXRIG_ASSIGN(Socket group, open_group(address, server));
    sockets.push_back(std::move(group));
  }
  return NatNetReceiver(server, std::move(sockets), version, clock);
}

/// Requests the stream. Without a server there is no answer, or an error that the next read
/// returns: neither ends the receiver.
void NatNetReceiver::request_stream() {
  const HostTime now = clock_->now();
  if (requested_ && now - *requested_ < kRequestEvery) return;
  requested_ = now;
  constexpr auto kPacket = connect_packet();
  (void)::sendto(sockets_.front().fd(), kPacket.data(), kPacket.size(), 0,
                 reinterpret_cast<const sockaddr*>(&server_), sizeof server_);
}

Result<std::optional<NatNetFrame>> NatNetReceiver::next(Duration timeout) {
  request_stream();
  std::array<pollfd, 2> wait{};
  for (std::size_t i = 0; i < sockets_.size(); ++i) wait[i] = {sockets_[i].fd(), POLLIN, 0};
  const auto until_request = kRequestEvery - (clock_->now() - *requested_);
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(
      std::max(std::min<Duration>(timeout, until_request), Duration(0)));
  if (::poll(wait.data(), sockets_.size(), static_cast<int>(ms.count())) < 0 && errno != EINTR)
    return socket_error("waiting failed");
  for (std::size_t i = 0; i < sockets_.size(); ++i)
    if (wait[i].revents != 0) return read(wait[i].fd);
  return std::optional<NatNetFrame>();
}

Result<std::optional<NatNetFrame>> NatNetReceiver::read(int fd) {
  sockaddr_in from{};
  socklen_t from_size = sizeof from;
  const ssize_t size = ::recvfrom(fd, buffer_.data(), buffer_.size(), MSG_DONTWAIT,
                                  reinterpret_cast<sockaddr*>(&from), &from_size);
  if (size < 0) {
    if (errno == EAGAIN || errno == EINTR || errno == ECONNREFUSED)
      return std::optional<NatNetFrame>();
    return socket_error("reading failed");
  }
  if (from.sin_addr.s_addr != server_.sin_addr.s_addr) {
    ++counts_.foreign;
    return std::optional<NatNetFrame>();
  }
  const auto packet = next_packet({buffer_.data(), static_cast<std::size_t>(size)});
  if (packet) return take(*packet, ntohs(from.sin_port));
  leave_out(packet.error());
  return std::optional<NatNetFrame>();
}

void NatNetReceiver::leave_out(const Error& why) {
  if (counts_.malformed++ == 0)
    log_warning("pose", "motion capture: " + why.context + ": such packets are left out");
}

Result<std::optional<NatNetFrame>> NatNetReceiver::take(const NatNetPacket& packet, int port) {
  if (packet.kind == static_cast<std::uint16_t>(NatNetKind::kServerInfo)) {
    const auto stated = parse_server_info(packet.payload);
    if (stated)
      version_ = *stated;
    else if (stated.error().code == ErrorCode::kUnsupported)
      return stated.error();
    else
      leave_out(stated.error());
  }
  if (packet.kind != static_cast<std::uint16_t>(NatNetKind::kFrame))
    return std::optional<NatNetFrame>();
  const HostTime now = clock_->now();
  if (!is_of_our_server(port, now)) {
    ++counts_.foreign;
    return std::optional<NatNetFrame>();
  }
  auto frame = parse_frame(packet.payload, version_);
  if (!frame) leave_out(frame.error());
  if (!frame || !is_next(frame->number, now)) return std::optional<NatNetFrame>();
  ++counts_.frames;
  return std::optional(*std::move(frame));
}

/// Whether a frame comes from our server, which sends from one port. Frames of another port are
/// accepted when the first has been silent for kServerGone.
bool NatNetReceiver::is_of_our_server(int port, HostTime now) {
  if (frame_port_ && *frame_port_ != port && now - last_frame_ < kServerGone) return false;
  frame_port_ = port;
  return true;
}

bool NatNetReceiver::is_next(int number, HostTime now) {
  const std::int64_t step = last_number_ ? std::int64_t{number} - *last_number_ : 1;
  const double most = kMostAtOnce + kMostRate_hz * seconds(now - last_frame_);
  last_frame_ = now;
  if (step <= 0 && !goes_on_from_before(number) && step > -kRestart) {
    ++counts_.late;
    return false;
  }
  back_run_ = 0;
  if (step > 1 && static_cast<double>(step) <= most) counts_.lost += static_cast<long>(step - 1);
  last_number_ = number;
  return true;
}

/// Notes a number that is not above the last one. Returns whether the last kBackRun numbers were
/// such and rose: the server restarted.
bool NatNetReceiver::goes_on_from_before(int number) {
  back_run_ = back_run_ > 0 && number > *back_number_ ? back_run_ + 1 : 1;
  back_number_ = number;
  return back_run_ >= kBackRun;
}

}  // namespace mixrig::stream
