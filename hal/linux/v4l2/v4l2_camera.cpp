// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/v4l2/v4l2_camera.h"

#include <algorithm>
#include <utility>

namespace mixrig::device {
namespace {

constexpr int kCameraBuffers = 10;
constexpr Duration kWait = std::chrono::milliseconds(100);

/// Whether a picture's bytes can stay in the driver's buffer: it is no file, and its frames have
/// the same bytes.
bool lends_format(const V4l2Layout& layout) {
  return layout.planes == 1 && layout.packed.packing == SamplePacking::kNone &&
         layout.format != PixelFormat::kMjpeg;
}

}  // namespace

V4l2Camera::V4l2Camera(std::string path, const StreamRequest& request, Clock& clock)
    : path_(std::move(path)), request_(request), clock_(clock), thread_(clock) {
  info_.uri = "v4l2:" + path_;
  info_.stamp_clock = StampClock::kHost;
}

Result<std::unique_ptr<V4l2Camera>> V4l2Camera::open(const std::string& path,
                                                     const StreamRequest& request, Clock& clock) {
  std::unique_ptr<V4l2Camera> camera(new V4l2Camera(path, request, clock));
  MIXRIG_TRY(camera->set_up());
  // A camera that is plugged in again must deliver what was negotiated first.
  camera->request_.size = camera->info_.size;
  camera->request_.format = camera->info_.format;
  camera->pool_.emplace(kCameraBuffers, camera->layout_.picture_bytes);
  return camera;
}

Result<void> V4l2Camera::set_up() {
  MIXRIG_ASSIGN(V4l2Node node, V4l2Node::open(path_));
  CameraInfo described = info_;
  MIXRIG_ASSIGN(const V4l2Layout layout, node.configure(request_, described));
  if (pool_ && (layout.picture_bytes != layout_.picture_bytes || described.model != info_.model))
    return Error{
        ErrorCode::kDevice,
        info_.uri +
            ": a different camera was plugged in: plug the first one in again, or restart mixrig"};
  for (const auto& [control, value] : settings_) (void)node.set(control, value);
  node_ = std::move(node);
  if (!pool_) info_ = described;  // callers hold references to it: not changed after open()
  layout_ = layout;
  return {};
}

Result<void> V4l2Camera::start(FrameSink sink) {
  if (thread_.runs()) return Error{ErrorCode::kUsage, info_.uri + ": the camera runs already"};
  {
    const std::lock_guard lock(mutex_);
    if (!node_.is_open()) MIXRIG_TRY(set_up());
    MIXRIG_TRY(node_.start_streaming(request_.lends && lends_format(layout_)));
    count_.health.state = DeviceState::kStreaming;
    count_.begin();
  }
  sink_ = std::move(sink);
  thread_.start([this] { work(); });
  return {};
}

void V4l2Camera::stop() {
  thread_.stop();
  const std::lock_guard lock(mutex_);
  node_.close();  // start() opens it again: some drivers cannot free single buffers
  count_.health.state = DeviceState::kStopped;
}

void V4l2Camera::work() {
  while (!thread_.stopping()) {
    auto next = node_.next(kWait);
    if (next && *next) {
      const bool lent = take(**next);
      if ((lent || node_.give_back(**next)) && node_.give_back_lent()) continue;
    } else if (next && node_.give_back_lent()) {
      continue;
    }
    come_back();
  }
}

/// Makes a frame of a picture; returns whether the picture's buffer is lent now.
bool V4l2Camera::take(const V4l2Picture& picture) {
  Frame frame{.format = layout_.format,
              .size = layout_.size,
              .stride_bytes = layout_.stride_bytes,
              .sequence = picture.sequence,
              .device_time = DeviceTime(picture.stamp.time_since_epoch()),
              .received = clock_.now(),
              .flags = payload_flags(layout_, picture.bytes, picture.error)};
  if (!picture.stamp_valid) frame.device_time = DeviceTime(frame.received.time_since_epoch());
  FramePool::Draft draft = pool_->take();
  {
    const std::lock_guard lock(mutex_);
    const auto exposure = settings_.find(CameraControl::kExposure);
    if (exposure != settings_.end())
      frame.exposure = Duration(static_cast<long>(exposure->second * 1e9));
    if (!count_.count(frame, static_cast<bool>(draft))) return false;
  }
  if (picture.stamp_is_start) frame.device_time += frame.exposure / 2;
  if (const FramePtr shared = lent(picture, frame)) {
    sink_(shared);
    return true;
  }
  const std::size_t used = copy_v4l2_picture(layout_, picture.bytes, draft.bytes());
  sink_(std::move(draft).publish(frame, used));
  return false;
}

/// Returns a frame in the kernel's buffer; null if that cannot be lent.
FramePtr V4l2Camera::lent(const V4l2Picture& picture, const Frame& frame) {
  if (!request_.lends || !lends_format(layout_) || frame.flags & kFrameIncomplete) return nullptr;
  const std::shared_ptr<LentPicture> out = lent_.take();
  if (!node_.lend(picture, *out)) return nullptr;
  out->frame = frame;
  out->frame.bytes = picture.bytes[0].first(layout_.picture_bytes);
  out->frame.memory = out->buffers->memory(picture.index, picture.begin);
  return {out, &out->frame};
}

/// Waits until the device is plugged in again.
void V4l2Camera::come_back() {
  {
    const std::lock_guard lock(mutex_);
    node_.close();
    count_.health.state = DeviceState::kLost;
  }
  thread_.find_again("v4l2", info_.uri, [this] {
    const std::lock_guard lock(mutex_);
    if (!set_up()) return false;
    if (!node_.start_streaming(request_.lends && lends_format(layout_))) {
      node_.close();
      return false;
    }
    count_.come_back();
    return true;
  });
}

const ControlRange* V4l2Camera::range(CameraControl control) const {
  const auto found = std::find_if(info_.controls.begin(), info_.controls.end(),
                                  [&](const ControlRange& r) { return r.control == control; });
  return found == info_.controls.end() ? nullptr : &*found;
}

Result<void> V4l2Camera::set(CameraControl control, double value) {
  const ControlRange* known = range(control);
  const std::string what = info_.uri + ": " + std::string(name(control));
  if (known == nullptr) return Error{ErrorCode::kUnsupported, what + " is not on this camera"};
  if (!(value >= known->minimum && value <= known->maximum))
    return Error{ErrorCode::kUsage, what + " must be " + std::to_string(known->minimum) + " to " +
                                        std::to_string(known->maximum)};
  const std::lock_guard lock(mutex_);
  if (!node_.is_open()) MIXRIG_TRY(set_up());
  MIXRIG_TRY(node_.set(control, value));
  settings_[control] = value;
  return {};
}

Result<double> V4l2Camera::get(CameraControl control) {
  if (range(control) == nullptr)
    return Error{ErrorCode::kUnsupported,
                 info_.uri + ": " + std::string(name(control)) + " is not on this camera"};
  const std::lock_guard lock(mutex_);
  if (!node_.is_open()) MIXRIG_TRY(set_up());
  return node_.get(control);
}

StreamHealth V4l2Camera::health() const {
  const std::lock_guard lock(mutex_);
  return count_.health;
}

}  // namespace mixrig::device
