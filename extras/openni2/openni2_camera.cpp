// SPDX-License-Identifier: Apache-2.0
#include "extras/openni2/openni2_camera.h"

#include <algorithm>
#include <utility>

#include "extras/openni2/openni2_device.h"
#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "hal/device/stream_count.h"

namespace mixrig::device {
namespace {

constexpr int kNiWait_ms = 100;
constexpr Duration kNiLookAgain = std::chrono::milliseconds(250);
constexpr std::uint64_t kMostNiTime_us = 1ULL << 52;  ///< a stamp that fits a Duration

}  // namespace

Result<void> OpenNi2Device::start(NiChannel& channel, FrameSink sink) {
  const std::lock_guard lock(mutex_);
  if (channel.sink) return Error{ErrorCode::kUsage, uri_ + ": the camera runs already"};
  channel.sink = std::move(sink);
  channel.count.begin();
  channel.count.health.state = DeviceState::kStreaming;
  if (!stop_) return {};
  for (const NiChannel& other : channels_)
    if (other.taken && !other.sink) return {};
  // A recording begins again at its first frame.
  if (recording_) disconnect();
  Result<void> ready = device_ != nullptr ? Result<void>() : connect();
  if (ready) ready = start_streams();
  if (!ready) {
    channel.sink = nullptr;
    channel.count.health.state = DeviceState::kStopped;
    return ready;
  }
  stop_ = false;
  thread_ = guarded_thread(
      "openni2", [this] { work(); }, log_end_of_driver);
  return {};
}

Result<void> OpenNi2Device::start_streams() {
  int count = 0;
  for (const NiChannel& channel : channels_) {
    if (channel.stream == nullptr) continue;
    if (oniStreamStart(channel.stream) != ONI_STATUS_OK)
      return openni2_error(uri_ + " (" + channel.name + ")", "starting the stream");
    ++count;
  }
  // Not for a recording, of which the library would hold frames back until their partners come.
  if (count > 1 && !recording_) (void)oniDeviceEnableDepthColorSync(device_);
  return {};
}

void OpenNi2Device::stop(NiChannel& channel) {
  std::thread done;
  {
    const std::lock_guard lock(mutex_);
    channel.sink = nullptr;
    channel.count.health.state = DeviceState::kStopped;
    for (const NiChannel& other : channels_)
      if (other.sink) return;
    stop_ = true;
    done = std::move(thread_);
  }
  if (!done.joinable()) return;
  done.join();
  for (NiChannel& other : channels_)
    if (other.stream != nullptr) oniStreamStop(other.stream);
}

StreamHealth OpenNi2Device::health(const NiChannel& channel) const {
  const std::lock_guard lock(mutex_);
  return channel.count.health;
}

void OpenNi2Device::work() {
  while (!stop_) {
    if (gone_) {
      come_back();
      continue;
    }
    // Read before waiting: the last frames of a recording are still delivered.
    const bool ended = ended_;
    std::array<OniStreamHandle, 2> streams{channels_[0].stream, channels_[1].stream};
    int which = 0;
    if (oniWaitForAnyStream(streams.data(), 2, &which, kNiWait_ms) != ONI_STATUS_OK) {
      if (ended) return set_state(DeviceState::kStopped);
      continue;
    }
    NiChannel& channel = channels_.at(static_cast<std::size_t>(which));
    OniFrame* frame = nullptr;
    if (oniStreamReadFrame(channel.stream, &frame) != ONI_STATUS_OK || frame == nullptr) continue;
    publish(channel, *frame);
    oniFrameRelease(frame);
  }
}

void OpenNi2Device::publish(NiChannel& channel, const OniFrame& frame) {
  Frame out{.format = channel.info.format,
            .size = channel.info.size,
            .stride_bytes = row_bytes(channel.info.format, channel.info.size.width),
            .sequence = static_cast<std::uint64_t>(std::max(frame.frameIndex, 0)),
            .device_time = DeviceTime(std::chrono::microseconds(frame.timestamp % kMostNiTime_us)),
            .received = clock_.now()};
  const std::lock_guard lock(mutex_);
  if (!channel.sink) return;
  auto draft = channel.pool->take();
  const bool whole = draft && copy_openni2(frame, channel.mode, draft.bytes());
  if (!whole) out.flags |= kFrameIncomplete;
  if (!channel.count.count(out, static_cast<bool>(draft))) return;
  const std::size_t bytes = whole ? draft.bytes().size() : 0;
  channel.sink(std::move(draft).publish(out, bytes));
}

void OpenNi2Device::set_state(DeviceState state) {
  const std::lock_guard lock(mutex_);
  for (NiChannel& channel : channels_)
    if (channel.sink) channel.count.health.state = state;
}

void OpenNi2Device::come_back() {
  set_state(DeviceState::kLost);
  log_warning("openni2", uri_ + ": lost; looking for it");
  disconnect();
  while (!stop_) {
    clock_.sleep_until(clock_.now() + kNiLookAgain);
    if (!connect() || !start_streams()) {
      disconnect();
      continue;
    }
    const std::lock_guard lock(mutex_);
    for (NiChannel& channel : channels_) {
      if (!channel.taken) continue;
      channel.count.come_back();
      if (!channel.sink) channel.count.health.state = DeviceState::kStopped;
    }
    log_warning("openni2", uri_ + ": is back");
    return;
  }
}

namespace {

class OpenNi2Camera final : public Camera {
 public:
  OpenNi2Camera(std::shared_ptr<OpenNi2Device> device, NiChannel& channel)
      : device_(std::move(device)), channel_(channel) {}
  ~OpenNi2Camera() override { stop(); }
  const CameraInfo& info() const override { return channel_.info; }
  Result<void> start(FrameSink sink) override { return device_->start(channel_, std::move(sink)); }
  void stop() override { device_->stop(channel_); }
  Result<void> set(CameraControl control, double) override { return refused(control); }
  Result<double> get(CameraControl control) override { return refused(control); }
  StreamHealth health() const override { return device_->health(channel_); }

 private:
  Error refused(CameraControl control) const {
    return Error{ErrorCode::kUnsupported,
                 channel_.info.uri + ": " + std::string(name(control)) + " is not on this camera"};
  }
  std::shared_ptr<OpenNi2Device> device_;
  NiChannel& channel_;
};

}  // namespace

Result<std::shared_ptr<OpenNi2Device>> open_openni2(const std::string& uri, Clock& clock) {
  auto device = std::make_shared<OpenNi2Device>(uri, clock);
  MIXRIG_TRY(device->open());
  return device;
}

Result<std::unique_ptr<Camera>> openni2_color(std::shared_ptr<OpenNi2Device> device,
                                              const StreamRequest& request) {
  MIXRIG_ASSIGN(NiChannel * channel, device->take(ONI_SENSOR_COLOR, request));
  return std::unique_ptr<Camera>(std::make_unique<OpenNi2Camera>(std::move(device), *channel));
}

Result<std::unique_ptr<DepthCamera>> openni2_depth(std::shared_ptr<OpenNi2Device> device,
                                                   const StreamRequest& request) {
  MIXRIG_ASSIGN(NiChannel * channel, device->take(ONI_SENSOR_DEPTH, request));
  const DepthInfo depth = channel->depth;
  return as_depth_camera(std::make_unique<OpenNi2Camera>(std::move(device), *channel), depth);
}

std::vector<std::string> list_openni2() {
  const NiLibrary library;
  std::vector<std::string> uris;
  if (library.works())
    for (const OniDeviceInfo& camera : NiLibrary::cameras()) uris.emplace_back(camera.uri);
  return uris;
}

}  // namespace mixrig::device
