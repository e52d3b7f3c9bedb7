// SPDX-License-Identifier: Apache-2.0
// A camera that a test drives frame by frame, with back doors for every fault.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <optional>

#include "hal/base/clock.h"
#include "hal/device/camera.h"
#include "hal/device/frame_pool.h"

namespace mixrig::fake {

/// The smallest whole driver. Frames are delivered on the thread that calls emit().
class FakeCamera final : public device::Camera {
 public:
  FakeCamera(Clock& clock, device::CameraInfo info, int buffers = 4);

  const device::CameraInfo& info() const override { return info_; }
  Result<void> start(device::FrameSink sink) override;
  void stop() override;
  Result<void> set(device::CameraControl control, double value) override;
  Result<double> get(device::CameraControl control) override;
  device::StreamHealth health() const override;

  /// One exposure now: the counter increments, and a frame whose bytes all hold the counter's low
  /// byte is delivered while it streams and is plugged in. `count` > 1 repeats the same counter.
  void emit(int count = 1);
  void drop_next(int frames) { drop_ += frames; }  ///< exposed, but never delivered
  void damage_next() { damage_ = true; }           ///< arrives incomplete
  void repeat();                                   ///< delivers the last frame once more
  void set_clock(Duration ahead);  ///< its stamps are the host's time plus this from now on
  void unplug();
  void replug();  ///< the counter restarts
  void fail_next_start(Error error) { start_error_ = std::move(error); }

 private:
  void deliver();

  Clock& clock_;
  device::CameraInfo info_;
  device::FramePool pool_;
  mutable std::mutex mutex_;
  device::FrameSink sink_;
  device::StreamHealth health_;
  std::map<device::CameraControl, double> settings_;
  std::optional<Error> start_error_;
  std::uint64_t sequence_ = 0;
  std::optional<std::uint64_t> last_;
  Duration clock_ahead_{};
  int drop_ = 0;
  bool damage_ = false, plugged_ = true, restarted_ = false;
};

}  // namespace mixrig::fake
