// SPDX-License-Identifier: Apache-2.0
// What the board's tests share: devices on the bench, frames that come from them, and programs.
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

/// How long a test waits for what must happen. On the board time is counted in instructions.
inline constexpr Duration kPatience = 20s;
/// A device that is back must deliver again within this time.
inline constexpr Duration kRecovery = 2s;

/// Waits until `done` holds; false when it never did.
bool wait_until(const std::function<bool()>& done, Duration patience = kPatience);

/// What is kept of the frames of a stream.
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

/// One line of figures for the log.
template <typename... T>
void measured(const char* pattern, T... values) {
  std::printf("  measured: ");
  std::printf(pattern, values...);
  std::printf("\n");
}

}  // namespace mixrig::board
