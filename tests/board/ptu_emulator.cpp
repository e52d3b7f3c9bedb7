// SPDX-License-Identifier: Apache-2.0
// The emulated pan-tilt unit behind a Unix socket, for QEMU's serial ports.
// usage: ptu_emulator SOCKET [silent|stalled|noisy|limits]
#include <array>
#include <cstdio>
#include <cstring>
#include <string_view>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "hal/fake/flir_ptu_emulator.h"

namespace {

int listen_on(const char* path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (std::strlen(path) >= sizeof address.sun_path) return -1;
  std::strcpy(address.sun_path, path);
  ::unlink(path);
  const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
  const bool bound =
      fd >= 0 && ::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  return bound && ::listen(fd, 1) == 0 ? fd : -1;
}

void serve(int peer, mixrig::fake::FlirPtuEmulator& unit) {
  mixrig::SystemClock clock;
  std::array<std::uint8_t, 256> bytes;
  while (true) {
    const ssize_t got = ::read(peer, bytes.data(), bytes.size());
    if (got <= 0) return;
    unit.receive({bytes.data(), static_cast<std::size_t>(got)}, clock.now());
    std::string& answer = unit.output();
    if (::write(peer, answer.data(), answer.size()) < 0) return;
    answer.clear();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  mixrig::fake::FlirPtuEmulator unit(1);
  const std::string_view fault = argc > 2 ? argv[2] : "";
  unit.faults.silent = fault == "silent";
  unit.faults.stalled = fault == "stalled";
  unit.faults.noise_share = fault == "noisy" ? 0.2 : 0;
  unit.faults.limit_report_share = fault == "limits" ? 0.2 : 0;
  const int listener = listen_on(argv[1]);
  if (listener < 0) {
    std::perror("ptu_emulator: cannot listen");
    return 1;
  }
  while (true) {
    const int peer = ::accept(listener, nullptr, nullptr);
    if (peer < 0) return 1;
    serve(peer, unit);
    ::close(peer);
  }
}
