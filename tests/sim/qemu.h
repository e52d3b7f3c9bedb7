// SPDX-License-Identifier: Apache-2.0
// QEMU with the firmware's machine, whose clock counts instructions (8 ns each).
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "hal/base/clock.h"
#include "hal/linux/posix_byte_stream.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::test {

inline constexpr int kQemuLimit_s = 120;  // real time; long enough for a busy machine

/// Emulated time while the processor sleeps: it jumps to the next event, or passes like real time,
/// which leaves the host's processor to other programs.
enum class IdleTime { kLeaps, kPasses };

/// QEMU with its serial line on a socket. It ends at a reset of the chip.
class Qemu {
 public:
  explicit Qemu(const std::string& kernel, const std::vector<std::string>& more = {},
                IdleTime idle = IdleTime::kLeaps) {
    const std::string clock = idle == IdleTime::kLeaps ? "shift=3,sleep=off" : "shift=3,sleep=on";
    std::vector<std::string> arguments = {"qemu-system-arm", "-M",   "netduinoplus2", "-nographic",
                                          "-monitor",        "none", "-no-reboot"};
    arguments.insert(arguments.end(), {"-icount", clock, "-kernel", kernel});
    arguments.insert(arguments.end(), {"-serial", "unix:" + socket() + ",server=on,wait=on"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    process_ = std::make_unique<ChildProcess>(std::move(arguments), kQemuLimit_s);
  }
  std::string socket() const { return folder_ / "serial"; }
  int wait() { return process_->wait(); }

  /// Waits until the socket listens; null where QEMU does not start.
  std::unique_ptr<device::ByteStream> connect(Clock& clock) {
    for (int i = 0; i < 12'000; ++i) {
      auto stream = device::PosixByteStream::connect_unix(socket());
      if (stream) return *std::move(stream);
      clock.sleep_until(clock.now() + std::chrono::milliseconds(5));
    }
    return nullptr;
  }

 private:
  TemporaryFolder folder_;
  std::unique_ptr<ChildProcess> process_;
};

}  // namespace mixrig::test
