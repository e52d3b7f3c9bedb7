// SPDX-License-Identifier: Apache-2.0
// A camera that a test drives frame by frame and in which it can cause every fault.
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

  /// Makes one exposure now: the counter increments and, if the camera streams and is plugged in, a
  /// frame is delivered whose bytes all hold the counter's low byte. `count` > 1 delivers further
  /// frames with the same counter.
  void emit(int count = 1);
  /// The next frames are exposed, but never delivered.
  void drop_next(int frames) { drop_ += frames; }
  void damage_next() { damage_ = true; }  ///< the next frame arrives incomplete
  void repeat();                          ///< delivers the last frame once more
  void set_clock(Duration ahead);         ///< from now on its stamps are host time plus `ahead`
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
