// SPDX-License-Identifier: Apache-2.0
#include "firmware/port/sim/sim_line.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

namespace mixrig::sim {

namespace {

std::string system_text(const std::string& what) { return what + ": " + std::strerror(errno); }

}  // namespace

std::optional<SimLine> SimLine::open_pty(const std::string& path, std::string& error) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  char name[128];
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
      ptsname_r(master, name, sizeof name) != 0) {
    error = system_text("cannot open a pty");
    if (master >= 0) close(master);
    return std::nullopt;
  }
  SimLine line(path, -1, master, open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (line.keep_open_ < 0 || tcgetattr(line.keep_open_, &settings) != 0) {
    error = system_text(std::string("cannot open ") + name);
    return std::nullopt;
  }
  cfmakeraw(&settings);
  tcsetattr(line.keep_open_, TCSANOW, &settings);
  unlink(path.c_str());
  if (symlink(name, path.c_str()) != 0) {
    error = system_text("cannot link " + path);
    return std::nullopt;
  }
  return line;
}

std::optional<SimLine> SimLine::open_socket(const std::string& path, std::string& error) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  // Binds a temporary name, listens, then renames: a socket at `path` can always be connected to.
  const std::string unnamed = path + "~";
  if (unnamed.size() >= sizeof address.sun_path) {
    error = "socket path is too long: " + path;
    return std::nullopt;
  }
  std::memcpy(address.sun_path, unnamed.c_str(), unnamed.size() + 1);
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  SimLine line(path, listener, -1, -1);
  unlink(unnamed.c_str());
  if (listener < 0 || bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      listen(listener, 1) != 0 || rename(unnamed.c_str(), path.c_str()) != 0) {
    error = system_text("cannot listen at " + path);
    return std::nullopt;
  }
  return line;
}

SimLine::SimLine(SimLine&& other) noexcept
    : path_(std::exchange(other.path_, {})),
      listener_(std::exchange(other.listener_, -1)),
      fd_(std::exchange(other.fd_, -1)),
      keep_open_(std::exchange(other.keep_open_, -1)) {}

SimLine::~SimLine() {
  for (const int fd : {listener_, fd_, keep_open_}) {
    if (fd >= 0) close(fd);
  }
  if (!path_.empty()) unlink(path_.c_str());
}

void SimLine::hang_up() {
  if (listener_ < 0) return;  // a pty stays open for the next reader
  close(fd_);
  fd_ = -1;
}

std::size_t SimLine::read(std::span<std::uint8_t> out, std::uint64_t timeout_us) {
  if (fd_ < 0) fd_ = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  pollfd wait{fd_ >= 0 ? fd_ : listener_, POLLIN, 0};
  const timespec timeout{static_cast<time_t>(timeout_us / 1'000'000),
                         static_cast<long>(timeout_us % 1'000'000 * 1000)};
  if (ppoll(&wait, 1, &timeout, nullptr) <= 0 || fd_ < 0) return 0;
  const ssize_t n = ::read(fd_, out.data(), out.size());
  if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) hang_up();
  return n > 0 ? static_cast<std::size_t>(n) : 0;
}

void SimLine::write(std::span<const std::uint8_t> bytes) {
  if (fd_ < 0 || bytes.empty()) return;
  const ssize_t n = listener_ >= 0 ? send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                   : ::write(fd_, bytes.data(), bytes.size());
  if (n < 0 && errno != EAGAIN && errno != EINTR) hang_up();
}

}  // namespace mixrig::sim
