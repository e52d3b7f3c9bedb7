// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/posix_byte_stream.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

namespace mixrig::device {

namespace {

constexpr int kWriteTimeoutMs = 1000;

Error open_error(const std::string& path, int error) {
  const ErrorCode code = error == ENOENT || error == ENXIO ? ErrorCode::kNotFound : ErrorCode::kIo;
  const char* hint = error == EACCES ? ": add yourself to group dialout"
                                     : ": is it plugged in, and is this its name?";
  return system_error(code, "cannot open " + path + hint, error);
}

Result<void> set_raw(int fd, const std::string& name) {
  termios settings{};
  if (tcgetattr(fd, &settings) != 0) {
    return system_error(ErrorCode::kIo, name + " is no terminal: give a serial port", errno);
  }
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  if (tcsetattr(fd, TCSANOW, &settings) != 0) {
    return system_error(ErrorCode::kIo, "cannot set up " + name, errno);
  }
  tcflush(fd, TCIFLUSH);
  return {};
}

/// Waits for `events`; false on time-out.
Result<bool> wait_for(int fd, short events, Duration timeout, const std::string& name) {
  pollfd wait{fd, events, 0};
  const auto ns = timeout.count() > 0 ? timeout.count() : 0;
  const timespec limit{static_cast<time_t>(ns / 1'000'000'000),
                       static_cast<long>(ns % 1'000'000'000)};
  const int ready = ppoll(&wait, 1, &limit, nullptr);
  if (ready < 0 && errno != EINTR) {
    return system_error(ErrorCode::kIo, "cannot wait for " + name, errno);
  }
  return ready > 0;
}

struct FreeAddresses {
  void operator()(addrinfo* addresses) const { freeaddrinfo(addresses); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

/// Resolves HOST:PORT or [HOST]:PORT.
Result<Addresses> resolve(const std::string& host_and_port) {
  const auto colon = host_and_port.rfind(':');
  std::string host = host_and_port.substr(0, colon);
  const std::string port = colon == std::string::npos ? "" : host_and_port.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == port.npos;
  if (host.empty() || !digits || std::stoi(port) < 1 || std::stoi(port) > 65535)
    return Error{ErrorCode::kUsage,
                 "'tcp:" + host_and_port + "' is no address: give tcp:HOST:PORT"};
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_socktype = SOCK_STREAM;
  const int failed = getaddrinfo(host.c_str(), port.c_str(), &wanted, &found);
  if (failed != 0)
    return Error{ErrorCode::kNotFound,
                 "no host '" + host + "': check its name (" + gai_strerror(failed) + ")"};
  return Addresses(found);
}

/// Connects a non-blocking socket.
Result<void> connect_within(int fd, const addrinfo& address, Duration timeout,
                            const std::string& name) {
  const std::string hint = "cannot connect to " + name +
                           ": is it switched on, and is this its "
                           "port?";
  if (connect(fd, address.ai_addr, address.ai_addrlen) == 0) return {};
  if (errno != EINPROGRESS) return system_error(ErrorCode::kIo, hint, errno);
  MIXRIG_ASSIGN(const bool ready, wait_for(fd, POLLOUT, timeout, name));
  if (!ready) return Error{ErrorCode::kTimeout, hint};
  int fault = 0;
  socklen_t size = sizeof fault;
  getsockopt(fd, SOL_SOCKET, SO_ERROR, &fault, &size);
  return fault == 0 ? Result<void>() : system_error(ErrorCode::kIo, hint, fault);
}

}  // namespace

PosixByteStream::PosixByteStream(int fd, std::string name) : fd_(fd), name_(std::move(name)) {
  int type = 0;
  socklen_t size = sizeof type;
  is_socket_ = getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0;
}

PosixByteStream::~PosixByteStream() { close(fd_); }

Result<std::unique_ptr<ByteStream>> PosixByteStream::open_terminal(const std::string& path) {
  const int fd = open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return open_error(path, errno);
  auto stream = std::make_unique<PosixByteStream>(fd, path);
  MIXRIG_TRY(set_raw(fd, path));
  return std::unique_ptr<ByteStream>(std::move(stream));
}

Result<std::unique_ptr<ByteStream>> PosixByteStream::connect_unix(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    return Error{ErrorCode::kUsage, "socket path is too long (107 bytes at most): " + path};
  }
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return system_error(ErrorCode::kIo, "cannot make a socket", errno);
  auto stream = std::make_unique<PosixByteStream>(fd, path);
  if (connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    return open_error(path, errno);
  }
  fcntl(fd, F_SETFL, O_NONBLOCK);
  return std::unique_ptr<ByteStream>(std::move(stream));
}

Result<std::unique_ptr<ByteStream>> PosixByteStream::connect_tcp(const std::string& host_and_port) {
  constexpr Duration kConnectTimeout = std::chrono::seconds(2);
  MIXRIG_ASSIGN(const Addresses addresses, resolve(host_and_port));
  Error last{ErrorCode::kNotFound, "no address of " + host_and_port};
  for (const addrinfo* at = addresses.get(); at != nullptr; at = at->ai_next) {
    const int fd = socket(at->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0) continue;
    auto stream = std::make_unique<PosixByteStream>(fd, "tcp:" + host_and_port);
    if (auto connected = connect_within(fd, *at, kConnectTimeout, host_and_port); !connected) {
      last = std::move(connected).error();
      continue;
    }
    const int on = 1;  // a question is one small packet: it must not wait for the next one
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return std::unique_ptr<ByteStream>(std::move(stream));
  }
  return last;
}

Result<std::size_t> PosixByteStream::read(std::span<std::uint8_t> out, Duration timeout) {
  MIXRIG_ASSIGN(const bool ready, wait_for(fd_, POLLIN, timeout, name_));
  if (!ready) return std::size_t{0};
  const ssize_t n = ::read(fd_, out.data(), out.size());
  if (n > 0) return static_cast<std::size_t>(n);
  if (n < 0 && (errno == EAGAIN || errno == EINTR)) return std::size_t{0};
  return system_error(ErrorCode::kDevice, "lost " + name_ + ": unplugged or hung up",
                      n < 0 ? errno : 0);
}

Result<void> PosixByteStream::write(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    // MSG_NOSIGNAL: writing to a closed socket would otherwise raise SIGPIPE and end this process.
    const ssize_t n = is_socket_ ? ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                 : ::write(fd_, bytes.data(), bytes.size());
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN) {
      return system_error(ErrorCode::kDevice, "lost " + name_ + ": unplugged or hung up", errno);
    }
    MIXRIG_ASSIGN(const bool ready,
                  wait_for(fd_, POLLOUT, std::chrono::milliseconds(kWriteTimeoutMs), name_));
    if (!ready) return Error{ErrorCode::kTimeout, name_ + " accepts no bytes: does it hang?"};
  }
  return {};
}

Result<void> PosixByteStream::set_line(const LineSettings& settings) {
  termios terminal{};
  if (tcgetattr(fd_, &terminal) != 0) return {};
  const speed_t speed = settings.baud == 115'200 ? B115200 : settings.baud == 9'600 ? B9600 : B0;
  if (speed == B0) {
    return Error{ErrorCode::kUnsupported,
                 name_ + ": unsupported rate, " + std::to_string(settings.baud) + " baud"};
  }
  cfsetspeed(&terminal, speed);
  terminal.c_cflag &= ~static_cast<tcflag_t>(PARENB | PARODD);
  if (settings.parity == Parity::kEven) terminal.c_cflag |= PARENB;
  if (tcsetattr(fd_, TCSADRAIN, &terminal) == 0) return {};
  // A pty ignores the parity flag, and the C library reports an error where nothing else changed.
  // That is accepted here.
  const int cause = errno;
  termios now{};
  const bool all_but_parity = tcgetattr(fd_, &now) == 0 && cfgetospeed(&now) == speed &&
                              (now.c_cflag | PARENB) == (terminal.c_cflag | PARENB);
  if (!all_but_parity) return system_error(ErrorCode::kIo, "cannot set up " + name_, cause);
  return {};
}

}  // namespace mixrig::device
