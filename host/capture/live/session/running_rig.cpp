// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/running_rig.h"

#include <utility>

#include "host/capture/live/session/live_capture.h"

namespace mixrig::live {
namespace {

Error no_rig() { return {ErrorCode::kUsage, "no rig with a pan-tilt unit runs"}; }

}  // namespace

Result<SweepFacts> sweep_facts(const RigConfig& config, const Devices& devices) {
  SweepFacts facts;
  facts.color_px = devices.cameras.front()->info().size;
  facts.depth_px = devices.depth->info().size;
  facts.unit = devices.pan_tilt->info();
  MIXRIG_ASSIGN(facts.take, take_info(config, devices));
  return facts;
}

void RunningRig::follow(const RigConfig& config, const Devices& devices, LiveSession& session) {
  if (!devices.pan_tilt || !devices.depth || devices.cameras.empty()) return;
  const std::scoped_lock lock(rig_mutex_, frame_mutex_);
  config_ = &config, devices_ = &devices, session_ = &session;
  begin_.emplace(config, devices);
  ended_ = there_ = false;
}

void RunningRig::end() {
  const std::scoped_lock lock(rig_mutex_, frame_mutex_);
  session_ = nullptr;
  ended_ = true;
  came_.notify_all();
}

void RunningRig::give(const LiveSet& set, const capture::Capture& capture) {
  if (!listens_ || !begin_ || capture.depth_m.empty()) return;
  const HostTime begin = begin_->of(set);
  const std::lock_guard lock(frame_mutex_);
  newest_ = capture;
  if (capture.picture) newest_.plate = plate_of(capture);  // without its camera's buffer
  newest_.picture.reset();
  exposed_from_ = begin, there_ = true;
  came_.notify_all();
}

bool RunningRig::runs() const {
  const std::lock_guard lock(rig_mutex_);
  return session_ != nullptr;
}

Result<SweepFacts> RunningRig::facts() const {
  const std::lock_guard lock(rig_mutex_);
  return session_ != nullptr ? sweep_facts(*config_, *devices_) : Result<SweepFacts>(no_rig());
}

device::PanTiltAngles RunningRig::step() const {
  const std::lock_guard lock(rig_mutex_);
  return session_ != nullptr ? devices_->pan_tilt->info().resolution : device::PanTiltAngles{};
}

Result<void> RunningRig::move_to(device::PanTiltAngles target) {
  const std::lock_guard lock(rig_mutex_);
  return session_ != nullptr ? session_->move_head(target) : Result<void>(no_rig());
}

Result<void> RunningRig::halt() {
  const std::lock_guard lock(rig_mutex_);
  return session_ != nullptr ? session_->halt_head() : Result<void>(no_rig());
}

Result<bool> RunningRig::next(Duration timeout, capture::Capture& frame, HostTime& exposed_from) {
  std::unique_lock lock(frame_mutex_);
  came_.wait_for(lock, timeout, [this] { return there_ || ended_; });
  if (ended_) return Error{ErrorCode::kDevice, "the cameras of the run have ended"};
  if (!std::exchange(there_, false)) return false;
  std::swap(frame, newest_);
  exposed_from = exposed_from_;
  return true;
}

}  // namespace mixrig::live
