// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/play/steered_head.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mixrig::live {
namespace {

constexpr Duration kAnswerEvery = std::chrono::milliseconds(10);
// Amplitude, rate and decay of the swing after a stop.
constexpr double kSwing_rad = 0.004, kSwing_hz = 7, kSwingDecay_s = 0.08;

double whole_steps(double angle_rad, double step_rad) {
  return step_rad > 0 ? step_rad * std::round(angle_rad / step_rad) : angle_rad;
}

class SteeredHead final : public device::PanTilt {
 public:
  SteeredHead(std::shared_ptr<SteeredMotion> motion, Clock& clock)
      : motion_(std::move(motion)), clock_(clock) {}
  const device::PanTiltInfo& info() const override { return motion_->info(); }
  Result<void> move_to(device::PanTiltAngles target) override {
    ++health_.commands;
    return motion_->move_to(target, clock_.now());
  }
  Result<void> set_motion(device::PanTiltMotion motion) override {
    ++health_.commands;
    if (!(motion.speed_rad_s >= 0 && motion.acceleration_rad_s2 >= 0))
      return Error{ErrorCode::kUsage, info().uri + ": speed or acceleration is out of range"};
    if (motion.speed_rad_s > 0) motion_->set_speed(motion.speed_rad_s);
    return {};
  }
  Result<void> halt() override {
    ++health_.commands;
    motion_->halt(clock_.now());
    return {};
  }
  Result<device::PanTiltSample> sample() override {
    clock_.sleep_until(next_);
    const HostTime now = clock_.now();
    next_ = now + kAnswerEvery;
    ++health_.commands;
    const device::PanTiltAngles at = motion_->at(now).angles, step = info().resolution;
    return device::PanTiltSample{
        {whole_steps(at.pan_rad, step.pan_rad), whole_steps(at.tilt_rad, step.tilt_rad)}, now, now};
  }
  device::PanTiltHealth health() const override { return health_; }

 private:
  const std::shared_ptr<SteeredMotion> motion_;
  Clock& clock_;
  HostTime next_{};
  device::PanTiltHealth health_;
};

/// Moves `from` towards `to`; the rate is 0 once it is there.
std::pair<double, double> towards(double from, double to, double way) {
  const double left = to - from;
  if (std::abs(left) <= way) return {to, 0};
  return {from + std::copysign(way, left), std::copysign(1, left)};
}

}  // namespace

capture::HeadMotion SteeredMotion::during(const Move& move, HostTime time) {
  const double since_s = std::max(0.0, seconds(time - move.begin));
  const double way_rad = move.speed_rad_s * since_s;
  const auto [pan, pan_sign] = towards(move.from.pan_rad, move.to.pan_rad, way_rad);
  const auto [tilt, tilt_sign] = towards(move.from.tilt_rad, move.to.tilt_rad, way_rad);
  capture::HeadMotion motion{{pan, tilt},
                             {pan_sign * move.speed_rad_s, tilt_sign * move.speed_rad_s}};
  const double turned_rad = std::max(std::abs(move.to.pan_rad - move.from.pan_rad),
                                     std::abs(move.to.tilt_rad - move.from.tilt_rad));
  const double rest_s = since_s - turned_rad / move.speed_rad_s;
  if (turned_rad > 0 && rest_s > 0)
    motion.swing_rad = kSwing_rad * std::exp(-rest_s / kSwingDecay_s) *
                       std::sin(2 * std::numbers::pi * kSwing_hz * rest_s);
  return motion;
}

capture::HeadMotion SteeredMotion::now_at(HostTime time) const {
  return during(time < newest_.begin ? before_ : newest_, time);
}

Result<void> SteeredMotion::move_to(device::PanTiltAngles target, HostTime now) {
  const auto inside = [](double v, double low, double high) { return v >= low && v <= high; };
  if (!inside(target.pan_rad, info_.minimum.pan_rad, info_.maximum.pan_rad) ||
      !inside(target.tilt_rad, info_.minimum.tilt_rad, info_.maximum.tilt_rad))
    return Error{ErrorCode::kUsage, info_.uri + ": target is out of range: nothing was moved"};
  const std::lock_guard lock(mutex_);
  const device::PanTiltAngles from = now_at(now).angles, step = info_.resolution;
  before_ = std::exchange(newest_, Move{now,
                                        from,
                                        {whole_steps(target.pan_rad, step.pan_rad),
                                         whole_steps(target.tilt_rad, step.tilt_rad)},
                                        speed_rad_s_});
  return {};
}

void SteeredMotion::halt(HostTime now) {
  const std::lock_guard lock(mutex_);
  const device::PanTiltAngles here = now_at(now).angles, step = info_.resolution;
  const device::PanTiltAngles rest{whole_steps(here.pan_rad, step.pan_rad),
                                   whole_steps(here.tilt_rad, step.tilt_rad)};
  before_ = std::exchange(newest_, Move{now, here, rest, speed_rad_s_});
}

void SteeredMotion::set_speed(double rad_s) {
  const std::lock_guard lock(mutex_);
  speed_rad_s_ = rad_s;
}

capture::HeadMotion SteeredMotion::at(HostTime time) const {
  const std::lock_guard lock(mutex_);
  return now_at(time);
}

std::unique_ptr<device::PanTilt> make_steered_head(std::shared_ptr<SteeredMotion> motion,
                                                   Clock& clock) {
  return std::make_unique<SteeredHead>(std::move(motion), clock);
}

}  // namespace mixrig::live
