// SPDX-License-Identifier: Apache-2.0
// The emulated pan-tilt unit behind a pseudo-terminal, for a program in another process.
#pragma once

#include <array>
#include <atomic>
#include <cstdlib>
#include <string>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "hal/fake/flir_ptu_emulator.h"

namespace mixrig::test {

/// Its axes move by the system's clock, in real time.
class PtuOnAPty {
 public:
  PtuOnAPty() : master_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0) return;
    name_ = ::ptsname(master_);
    thread_ = std::thread([this] { work(); });
  }
  ~PtuOnAPty() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    if (master_ >= 0) ::close(master_);
  }
  PtuOnAPty(const PtuOnAPty&) = delete;
  PtuOnAPty& operator=(const PtuOnAPty&) = delete;

  const std::string& name() const { return name_; }  ///< empty where there is no terminal
  void set_silent(bool silent) { silent_ = silent; }

 private:
  void work() {
    std::array<std::uint8_t, 256> bytes{};
    const SystemClock clock;
    while (!stop_) {
      pollfd poll{master_, POLLIN, 0};
      if (::poll(&poll, 1, 50) <= 0) continue;
      const ssize_t count = ::read(master_, bytes.data(), bytes.size());
      if (count <= 0) {  // the other side is not open
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      unit_.faults.silent = silent_;
      unit_.receive({bytes.data(), static_cast<std::size_t>(count)}, clock.now());
      std::string& out = unit_.output();
      const ssize_t written = out.empty() ? 0 : ::write(master_, out.data(), out.size());
      if (written > 0) out.erase(0, static_cast<std::size_t>(written));
    }
  }

  int master_ = -1;
  std::string name_;
  fake::FlirPtuEmulator unit_{3};
  std::atomic<bool> stop_ = false, silent_ = false;
  std::thread thread_;
};

}  // namespace mixrig::test
