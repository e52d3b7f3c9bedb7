// SPDX-License-Identifier: Apache-2.0
// A pan-tilt head without a serial line: it moves by the given clock, and tests can cause faults.
#pragma once

#include <mutex>

#include "hal/base/clock.h"
#include "hal/device/pan_tilt.h"

namespace mixrig::fake {

/// A pan-tilt head for tests. Any thread may call its methods.
class FakePanTilt final : public device::PanTilt {
 public:
  enum class Fault {
    kNone,
    kSilent,   ///< every call fails with kTimeout
    kGarbage,  ///< every call fails with kDevice: an invalid answer
    kStalled,  ///< answers, but does not move
    kThrows,   ///< every call throws std::bad_alloc
  };
  explicit FakePanTilt(Clock& clock);

  const device::PanTiltInfo& info() const override { return info_; }
  Result<void> move_to(device::PanTiltAngles target) override;
  Result<void> set_motion(device::PanTiltMotion motion) override;
  Result<device::PanTiltSample> sample() override;
  Result<void> halt() override;
  device::PanTiltHealth health() const override;

  void set_fault(Fault fault);
  /// Makes the head report that it hit a limit.
  void hit_limit();

 private:
  Result<void> answer();
  void move();

  Clock& clock_;
  device::PanTiltInfo info_;
  mutable std::mutex mutex_;
  device::PanTiltHealth health_;
  device::PanTiltAngles at_, target_;
  double speed_rad_s_ = 1;
  HostTime moved_{};
  Fault fault_ = Fault::kNone;
};

}  // namespace mixrig::fake
