// SPDX-License-Identifier: Apache-2.0
// Helpers shared by the board's tests: waiting, collecting frames, and running programs.
#pragma once

#include <condition_variable>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/device/camera.h"
#include "tests/board/vhci_port.h"

namespace mixrig::board {

using namespace std::chrono_literals;

/// How long a test waits for something that must happen. On the board, time is counted in
/// instructions.
inline constexpr Duration kTimeout = 20s;
/// A device must deliver again within this time after it was plugged in again.
inline constexpr Duration kRecovery = 2s;

/// Waits until `done` holds, asked every `look`; false when it never did.
bool wait_until(const std::function<bool()>& done, Duration timeout = kTimeout,
                Duration look = 2ms);

/// The recorded data of a stream's frames.
class Frames {
 public:
  struct Seen {
    std::uint64_t sequence;
    DeviceTime device_time;
    HostTime received;
    std::size_t bytes;
    std::uint32_t flags;
  };
  device::FrameSink sink();
  /// Waits for `count` frames more than there are now.
  bool wait_for_more(std::size_t count);
  std::vector<Seen> seen() const;
  device::FramePtr last() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Seen> seen_;
  device::FramePtr last_;
};

/// Output and exit status of a shell command.
struct Ran {
  int status = -1;
  std::string text;
};
Ran run(const std::string& command);

/// Prints one line of measured figures to the log; `pattern` is that of printf.
template <typename... T>
void measured(const char* pattern, T... values) {
  std::printf("  measured: ");
  std::printf(pattern, values...);
  std::printf("\n");
}

}  // namespace mixrig::board
