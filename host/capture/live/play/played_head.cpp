// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/play/played_head.h"

#include <utility>

namespace mixrig::live {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(10);

class PlayedHead final : public device::PanTilt {
 public:
  PlayedHead(std::shared_ptr<const PlayedAngles> angles, device::PanTiltInfo info, Clock& clock)
      : angles_(std::move(angles)), info_(std::move(info)), clock_(clock) {}
  const device::PanTiltInfo& info() const override { return info_; }
  Result<void> move_to(device::PanTiltAngles) override { return refused(); }
  Result<void> set_motion(device::PanTiltMotion) override { return refused(); }
  Result<void> halt() override { return refused(); }
  Result<device::PanTiltSample> sample() override {
    clock_.sleep_until(next_);
    const HostTime now = clock_.now();
    next_ = now + kStep;
    ++health_.commands;
    return angles_->at(now);
  }
  device::PanTiltHealth health() const override { return health_; }

 private:
  Error refused() const {
    return {ErrorCode::kUnsupported, info_.uri + ": the head of a recording cannot be moved"};
  }
  const std::shared_ptr<const PlayedAngles> angles_;
  const device::PanTiltInfo info_;
  Clock& clock_;
  HostTime next_{};
  device::PanTiltHealth health_;
};

}  // namespace

void PlayedAngles::restart() {
  const std::lock_guard lock(mutex_);
  count_ = 0;
  ended_ = false;
}

void PlayedAngles::add(HostTime at, device::PanTiltAngles angles) {
  const std::lock_guard lock(mutex_);
  before_ = count_ > 0 ? newest_ : Point{at, angles};
  newest_ = {at, angles};
  count_ = count_ > 0 ? 2 : 1;
}

void PlayedAngles::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
}

device::PanTiltSample PlayedAngles::at(HostTime now) const {
  const std::lock_guard lock(mutex_);
  if (count_ == 0) return {first_, now, now};
  if (now <= before_.at) return {before_.angles, now, now};
  if (now >= newest_.at) {
    const HostTime at = ended_ ? now : newest_.at;
    return {newest_.angles, at, at};
  }
  const double part = seconds(now - before_.at) / seconds(newest_.at - before_.at);
  const device::PanTiltAngles &a = before_.angles, &b = newest_.angles;
  return {
      {a.pan_rad + part * (b.pan_rad - a.pan_rad), a.tilt_rad + part * (b.tilt_rad - a.tilt_rad)},
      now,
      now};
}

std::unique_ptr<device::PanTilt> make_played_head(std::shared_ptr<const PlayedAngles> angles,
                                                  device::PanTiltInfo info, Clock& clock) {
  return std::make_unique<PlayedHead>(std::move(angles), std::move(info), clock);
}

}  // namespace mixrig::live
