// SPDX-License-Identifier: Apache-2.0
// What camera drivers share: what they count of a stream, and the thread that serves it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>

#include "hal/base/clock.h"
#include "hal/device/camera.h"

namespace mixrig::device {

/// Health of a stream of frames with a counter of the device. Not thread-safe: a driver guards it
/// with its own mutex.
class StreamCount {
 public:
  /// The device counts anew: nothing is lost before the next frame.
  void begin() { last_.reset(); }
  /// The device was lost and streams again; its next frame is flagged kFrameRestarted.
  void come_back();
  /// Flags a frame by its sequence and counts it; `frame` has kFrameIncomplete where it is not
  /// whole. False where it is not to be published, since every buffer is in use.
  bool count(Frame& frame, bool has_buffer);

  StreamHealth health;

 private:
  std::optional<std::uint64_t> last_;
  bool restarted_ = false;
};

/// The thread of a driver. start, stop and runs are for one thread, stopping for any, find_again
/// for the driver's own.
class DriverThread {
 public:
  explicit DriverThread(Clock& clock) : clock_(clock) {}
  ~DriverThread() { stop(); }

  bool runs() const { return thread_.joinable(); }
  /// `work` returns soon after stopping() is true. Precondition: it does not run.
  void start(std::function<void()> work);
  /// Returns when `work` has returned; false where it did not run.
  bool stop();
  bool stopping() const { return stop_; }
  /// Calls `find` four times a second until it is true; false where stop() came first. `who` and
  /// `uri` are for the log, which has two lines, however often it tries.
  bool find_again(const char* who, const std::string& uri, const std::function<bool()>& find);

 private:
  Clock& clock_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace mixrig::device
