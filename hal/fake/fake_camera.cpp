// SPDX-License-Identifier: Apache-2.0
#include "hal/fake/fake_camera.h"

#include <algorithm>
#include <utility>

namespace mixrig::fake {
namespace {

std::size_t frame_bytes(const device::CameraInfo& info) {
  return device::image_bytes(info.format, info.size,
                             device::row_bytes(info.format, info.size.width));
}

}  // namespace

FakeCamera::FakeCamera(Clock& clock, device::CameraInfo info, int buffers)
    : clock_(clock), info_(std::move(info)), pool_(buffers, frame_bytes(info_)) {}

Result<void> FakeCamera::start(device::FrameSink sink) {
  const std::lock_guard lock(mutex_);
  if (sink_) return Error{ErrorCode::kUsage, info_.uri + ": the camera runs already"};
  if (start_error_) return *std::exchange(start_error_, std::nullopt);
  if (!plugged_) return Error{ErrorCode::kDevice, info_.uri + ": not plugged in"};
  sink_ = std::move(sink);
  health_.state = device::DeviceState::kStreaming;
  return {};
}

void FakeCamera::stop() {
  const std::lock_guard lock(mutex_);
  sink_ = nullptr;
  last_.reset();
  health_.state = device::DeviceState::kStopped;
}

Result<void> FakeCamera::set(device::CameraControl control, double value) {
  const auto range = std::find_if(info_.controls.begin(), info_.controls.end(),
                                  [&](const auto& r) { return r.control == control; });
  const std::string what = info_.uri + ": " + std::string(device::name(control));
  if (range == info_.controls.end())
    return Error{ErrorCode::kUnsupported, what + " cannot be set on this camera"};
  if (!(value >= range->minimum && value <= range->maximum))
    return Error{ErrorCode::kUsage, what + " is out of its range"};
  settings_[control] = value;
  return {};
}

Result<double> FakeCamera::get(device::CameraControl control) {
  const auto found = settings_.find(control);
  if (found != settings_.end()) return found->second;
  for (const auto& range : info_.controls)
    if (range.control == control) return range.minimum;
  return Error{ErrorCode::kUnsupported,
               info_.uri + ": " + std::string(device::name(control)) + " is not on this camera"};
}

device::StreamHealth FakeCamera::health() const {
  const std::lock_guard lock(mutex_);
  return health_;
}

void FakeCamera::emit(int count) {
  const std::lock_guard lock(mutex_);
  ++sequence_;
  if (!sink_ || !plugged_) return;
  if (drop_ > 0) {
    --drop_;
    return;
  }
  for (int i = 0; i < count; ++i) deliver();
}

void FakeCamera::repeat() {
  const std::lock_guard lock(mutex_);
  if (sink_ && plugged_ && last_) deliver();
}

void FakeCamera::set_clock(Duration ahead) {
  const std::lock_guard lock(mutex_);
  clock_ahead_ = ahead;
}

void FakeCamera::deliver() {
  auto draft = pool_.take();
  if (!draft) {
    ++health_.overrun;
    return;
  }
  std::fill(draft.bytes().begin(), draft.bytes().end(), static_cast<std::uint8_t>(sequence_));
  device::Frame frame{.format = info_.format,
                      .size = info_.size,
                      .stride_bytes = device::row_bytes(info_.format, info_.size.width),
                      .sequence = sequence_,
                      .device_time = DeviceTime(clock_.now().time_since_epoch() + clock_ahead_),
                      .received = clock_.now()};
  if (std::exchange(restarted_, false)) frame.flags |= device::kFrameRestarted;
  if (last_ && sequence_ > *last_ + 1) {
    frame.flags |= device::kFrameAfterGap;
    health_.lost += sequence_ - *last_ - 1;
  }
  last_ = sequence_;
  if (std::exchange(damage_, false)) {
    frame.flags |= device::kFrameIncomplete;
    ++health_.incomplete;
  }
  ++health_.frames;
  const std::size_t used = draft.bytes().size();
  sink_(std::move(draft).publish(frame, used));
}

void FakeCamera::unplug() {
  const std::lock_guard lock(mutex_);
  plugged_ = false;
  if (sink_) health_.state = device::DeviceState::kLost;
}

void FakeCamera::replug() {
  const std::lock_guard lock(mutex_);
  if (plugged_) return;
  plugged_ = true;
  sequence_ = 0;
  last_.reset();
  if (!sink_) return;
  restarted_ = true;
  ++health_.returns;
  health_.state = device::DeviceState::kStreaming;
}

}  // namespace mixrig::fake
