// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/fake_pan_tilt.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace mixrig::fake {
namespace {

constexpr double kStep_rad = 0.001;

double in_steps(double angle_rad) { return std::round(angle_rad / kStep_rad) * kStep_rad; }

}  // namespace

FakePanTilt::FakePanTilt(Clock& clock) : clock_(clock), moved_(clock.now()) {
  info_.uri = "fake:pan_tilt";
  info_.version = "fake";
  info_.resolution = {kStep_rad, kStep_rad};
  info_.minimum = {-2.5, -0.8};
  info_.maximum = {2.5, 0.5};
}

/// Counts the command and returns the error of the present fault. Call with the lock held.
Result<void> FakePanTilt::answer() {
  if (fault_ == Fault::kThrows) throw std::bad_alloc();
  ++health_.commands;
  if (fault_ == Fault::kSilent) {
    ++health_.timeouts;
    return Error{ErrorCode::kTimeout, info_.uri + ": pan-tilt unit does not answer"};
  }
  if (fault_ == Fault::kGarbage) {
    ++health_.noise_bytes;
    return Error{ErrorCode::kDevice, info_.uri + ": pan-tilt unit gives no valid answer"};
  }
  return {};
}

void FakePanTilt::move() {
  const double way_rad = speed_rad_s_ * seconds(clock_.now() - moved_);
  moved_ = clock_.now();
  if (fault_ == Fault::kStalled) return;
  at_.pan_rad += std::clamp(target_.pan_rad - at_.pan_rad, -way_rad, way_rad);
  at_.tilt_rad += std::clamp(target_.tilt_rad - at_.tilt_rad, -way_rad, way_rad);
}

Result<void> FakePanTilt::move_to(device::PanTiltAngles target) {
  const std::lock_guard lock(mutex_);
  const auto inside = [](double v, double low, double high) { return v >= low && v <= high; };
  if (!inside(target.pan_rad, info_.minimum.pan_rad, info_.maximum.pan_rad) ||
      !inside(target.tilt_rad, info_.minimum.tilt_rad, info_.maximum.tilt_rad))
    return Error{ErrorCode::kUsage, info_.uri + ": target is out of range: nothing was moved"};
  MIXRIG_TRY(answer());
  move();
  health_.limit_hit = false;
  target_ = {in_steps(target.pan_rad), in_steps(target.tilt_rad)};
  return {};
}

Result<void> FakePanTilt::set_motion(device::PanTiltMotion motion) {
  const std::lock_guard lock(mutex_);
  MIXRIG_TRY(answer());
  move();
  if (motion.speed_rad_s < 0 || motion.acceleration_rad_s2 < 0)
    return Error{ErrorCode::kUsage, info_.uri + ": speed or acceleration is out of range"};
  if (motion.speed_rad_s > 0) speed_rad_s_ = motion.speed_rad_s;
  return {};
}

Result<device::PanTiltSample> FakePanTilt::sample() {
  const std::lock_guard lock(mutex_);
  MIXRIG_TRY(answer());
  move();
  return device::PanTiltSample{
      {in_steps(at_.pan_rad), in_steps(at_.tilt_rad)}, clock_.now(), clock_.now()};
}

Result<void> FakePanTilt::halt() {
  const std::lock_guard lock(mutex_);
  MIXRIG_TRY(answer());
  move();
  target_ = {in_steps(at_.pan_rad), in_steps(at_.tilt_rad)};
  return {};
}

device::PanTiltHealth FakePanTilt::health() const {
  const std::lock_guard lock(mutex_);
  return health_;
}

void FakePanTilt::set_fault(Fault fault) {
  const std::lock_guard lock(mutex_);
  fault_ = fault;
}

void FakePanTilt::hit_limit() {
  const std::lock_guard lock(mutex_);
  ++health_.limit_hits;
  health_.limit_hit = true;
}

}  // namespace mixrig::fake
