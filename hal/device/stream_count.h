// SPDX-License-Identifier: Apache-2.0
// Counters and the serving thread that camera drivers share.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>

#include "hal/base/clock.h"
#include "hal/device/camera.h"

namespace mixrig::device {

/// Counts on where a counter of a device wraps: one of 32 bits, or of 16 bits that leaves out 0
/// (GigE Vision 1, every 44 min at 25 Hz).
class CounterLine {
 public:
  /// Returns the counter with its wraps. A counter that begins again elsewhere is no wrap.
  std::uint64_t at(std::uint64_t raw);

 private:
  std::uint64_t last_ = 0, turns_ = 0;
};

/// Health of a stream of frames with a counter of the device. Not thread-safe: a driver guards it
/// with its own mutex.
class StreamCount {
 public:
  /// Call it when the device restarts its counter: no frame counts as lost before the next one.
  void begin() { last_.reset(), line_ = {}; }
  /// Call it when a lost device streams again: its next frame is flagged kFrameRestarted.
  void come_back();
  /// Sets the flags of a frame by its sequence number, counts it, and gives it the number with its
  /// wraps (CounterLine); the caller has set
  /// kFrameIncomplete where it is not whole. Returns false, counted as overrun, where every buffer
  /// is in use: do not publish it then.
  bool count(Frame& frame, bool has_buffer);

  StreamHealth health;

 private:
  std::optional<std::uint64_t> last_;
  bool restarted_ = false;
  CounterLine line_;
};

/// Logs what has ended the thread of a driver.
void log_end_of_driver(const Error& error);

/// The thread of a driver. One thread calls start, stop and runs, any thread stopping; the driver's
/// own thread calls find_again.
class DriverThread {
 public:
  explicit DriverThread(Clock& clock) : clock_(clock) {}
  ~DriverThread() { stop(); }

  bool runs() const { return thread_.joinable(); }
  /// Starts the thread with `work`, which must return soon after stopping() is true. What it throws
  /// is logged and ends it: a run whose camera is silent ends. Precondition: the thread does not
  /// run.
  void start(std::function<void()> work);
  /// Asks `work` to end and returns once it has; false if it did not run.
  bool stop();
  bool stopping() const { return stop_; }
  /// Calls `find` four times a second until it returns true; returns false if stop() came first.
  /// `who` and `uri` name the device in the log, which gets two lines, however many tries there
  /// are.
  bool find_again(const char* who, const std::string& uri, const std::function<bool()>& find);

 private:
  Clock& clock_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace mixrig::device
