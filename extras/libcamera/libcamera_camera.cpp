// SPDX-License-Identifier: Apache-2.0
#include "extras/libcamera/libcamera_camera.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include <libcamera/camera.h>
#include <libcamera/camera_manager.h>
#include <libcamera/control_ids.h>
#include <libcamera/framebuffer_allocator.h>
#include <libcamera/property_ids.h>
#include <libcamera/request.h>

#include "extras/libcamera/libcamera_format.h"
#include "extras/libcamera/libcamera_parts.h"
#include "hal/device/frame_pool.h"
#include "hal/device/stream_count.h"

namespace mixrig::device {
namespace {

constexpr int kLibcameraFrames = 10;
constexpr unsigned kLibcameraBuffers = 6;
constexpr Duration kLibcameraWait = std::chrono::milliseconds(100);
constexpr Duration kLibcameraSilence = std::chrono::seconds(2);  ///< then it is lost

class LibcameraCamera final : public Camera {
 public:
  LibcameraCamera(std::string id, const StreamRequest& request, Clock& clock)
      : id_(std::move(id)), request_(request), clock_(clock), thread_(clock) {
    info_.uri = "libcamera:" + id_;
    info_.stamp_clock = StampClock::kHost;
  }
  ~LibcameraCamera() override {
    stop();
    let_go();
  }
  Result<void> open();

  const CameraInfo& info() const override { return info_; }
  Result<void> start(FrameSink sink) override;
  void stop() override;
  Result<void> set(CameraControl control, double value) override;
  Result<double> get(CameraControl control) override;
  StreamHealth health() const override;

 private:
  Result<void> take_hold();
  void let_go();
  Result<void> configure();
  Result<void> choose(lc::CameraConfiguration& configuration, CameraInfo& described);
  Result<void> start_stream();
  void end_stream();
  void abandon();
  void work();
  void note_silence(bool frame);
  void take(lc::Request* request);
  void come_back();
  void completed(lc::Request* request);
  void vanished() { gone_ = true; }
  void put_settings(lc::ControlList& controls) const;
  void describe_controls();
  Error failed(const std::string& what, int code) const {
    return system_error(ErrorCode::kDevice, info_.uri + ": " + what, -code);
  }

  std::string id_;
  StreamRequest request_;
  Clock& clock_;
  CameraInfo info_;
  std::shared_ptr<lc::CameraManager> manager_;
  std::shared_ptr<lc::Camera> camera_;
  std::unique_ptr<lc::CameraConfiguration> configuration_;
  std::unique_ptr<lc::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<lc::Request>> requests_;
  std::map<const lc::FrameBuffer*, MappedBuffer> maps_;
  V4l2Layout layout_;
  std::optional<FramePool> pool_;
  FrameSink sink_;
  std::atomic<bool> gone_ = false;
  HostTime last_frame_{};  ///< of the driver's thread
  bool silent_ = false;    ///< the same; read by others when it has ended
  std::mutex done_mutex_;  ///< guards done_; the library's thread takes it
  std::condition_variable done_changed_;
  std::deque<lc::Request*> done_;
  mutable std::mutex mutex_;  ///< guards count_ and settings_
  StreamCount count_;
  std::map<CameraControl, double> settings_;
  DriverThread thread_;
};

Result<void> LibcameraCamera::open() {
  MIXRIG_ASSIGN(manager_, libcamera_manager());
  MIXRIG_TRY(take_hold());
  const auto& properties = camera_->properties();
  if (const auto model = properties.get(lc::properties::Model)) info_.model = *model;
  describe_controls();
  // A camera that is plugged in again must deliver what was negotiated first.
  request_.size = info_.size;
  request_.format = info_.format;
  pool_.emplace(kLibcameraFrames, layout_.picture_bytes);
  return {};
}

/// Finds the camera, claims and configures it.
Result<void> LibcameraCamera::take_hold() {
  const auto cameras = manager_->cameras();
  std::string there;
  for (const auto& camera : cameras) {
    there += " " + camera->id();
    if (camera->id() == id_ || (id_ == "any" && cameras.size() == 1)) camera_ = camera;
  }
  if (!camera_)
    return Error{ErrorCode::kNotFound, info_.uri + ": no such camera; there is:" +
                                           (there.empty() ? std::string(" none") : there)};
  if (const int code = camera_->acquire(); code != 0) {
    camera_.reset();
    return failed("claiming it (does another program use it?)", code);
  }
  id_ = camera_->id();
  gone_ = false;
  camera_->requestCompleted.connect(this, &LibcameraCamera::completed);
  camera_->disconnected.connect(this, &LibcameraCamera::vanished);
  const auto done = configure();
  if (!done) let_go();
  return done;
}

void LibcameraCamera::let_go() {
  requests_.clear();
  maps_.clear();
  allocator_.reset();
  configuration_.reset();
  if (!camera_) return;
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  camera_->release();
  camera_.reset();
}

Result<void> LibcameraCamera::choose(lc::CameraConfiguration& configuration,
                                     CameraInfo& described) {
  lc::StreamConfiguration& stream = configuration.at(0);
  const auto modes = libcamera_modes(stream.formats(), !request_.size.empty());
  MIXRIG_ASSIGN(const V4l2Choice choice, choose_mode(modes, request_));
  for (const lc::PixelFormat& format : stream.formats().pixelformats())
    if (v4l2_of_drm(format.fourcc(), format.modifier(), 1) == choice.code)
      stream.pixelFormat = format;
  stream.size = {static_cast<unsigned>(choice.size.width),
                 static_cast<unsigned>(choice.size.height)};
  stream.bufferCount = kLibcameraBuffers;
  const lc::PixelFormat wanted = stream.pixelFormat;
  const lc::Size size = stream.size;
  if (configuration.validate() == lc::CameraConfiguration::Invalid ||
      stream.pixelFormat != wanted || stream.size != size)
    return Error{ErrorCode::kUnsupported, info_.uri + ": does not deliver " + wanted.toString() +
                                              " of " + size.toString() +
                                              ", which it offers: give another size_px or format"};
  described.format = choice.format;
  described.size = choice.size;
  described.color = libcamera_encoding(stream.colorSpace);
  return {};
}

Result<void> LibcameraCamera::configure() {
  configuration_ = camera_->generateConfiguration({lc::StreamRole::VideoRecording});
  if (!configuration_ || configuration_->empty())
    return Error{ErrorCode::kUnsupported, info_.uri + ": has no stream of video"};
  CameraInfo described = info_;
  MIXRIG_TRY(choose(*configuration_, described));
  if (const int code = camera_->configure(configuration_.get()); code != 0)
    return failed("configuring it", code);
  lc::StreamConfiguration& stream = configuration_->at(0);
  allocator_ = std::make_unique<lc::FrameBufferAllocator>(camera_);
  if (const int code = allocator_->allocate(stream.stream()); code < 0)
    return failed("allocating buffers", code);
  std::vector<V4l2Plane> planes;
  for (const auto& buffer : allocator_->buffers(stream.stream())) {
    auto mapped = MappedBuffer::map(*buffer);
    if (!mapped) return failed("mapping a buffer", -errno);
    maps_.emplace(buffer.get(), *std::move(mapped));
    auto request = camera_->createRequest();
    if (!request || request->addBuffer(stream.stream(), buffer.get()) != 0)
      return Error{ErrorCode::kDevice, info_.uri + ": a request could not be made"};
    requests_.push_back(std::move(request));
    planes.clear();
    for (const auto& plane : buffer->planes()) planes.push_back({stream.stride, plane.length});
  }
  const std::uint32_t code =
      v4l2_of_drm(stream.pixelFormat.fourcc(), stream.pixelFormat.modifier(), planes.size());
  MIXRIG_ASSIGN(const V4l2Layout layout,
                checked_layout(code, stream.size.width, stream.size.height, planes));
  described.sample_bits = layout.sample_bits;
  if (pool_ && layout.picture_bytes != layout_.picture_bytes)
    return Error{
        ErrorCode::kDevice,
        info_.uri +
            ": a different camera was plugged in: plug the first one in again, or restart mixrig"};
  layout_ = layout;
  if (!pool_) info_ = described;  // callers hold references to it: not changed after open()
  return {};
}

void LibcameraCamera::describe_controls() {
  const lc::ControlInfoMap& known = camera_->controls();
  if (const auto at = known.find(&lc::controls::ExposureTime); at != known.end())
    info_.controls.push_back({CameraControl::kExposure, 1e-6 * at->second.min().get<std::int32_t>(),
                              1e-6 * at->second.max().get<std::int32_t>(), 1e-6});
  if (const auto at = known.find(&lc::controls::AnalogueGain); at != known.end())
    info_.controls.push_back({CameraControl::kGain,
                              static_cast<double>(at->second.min().get<float>()),
                              static_cast<double>(at->second.max().get<float>()), 0.01});
}

/// Writes the settings into a request; automatic exposure is off where one is set.
void LibcameraCamera::put_settings(lc::ControlList& controls) const {
  const lc::ControlInfoMap& known = camera_->controls();
  for (const auto& [control, value] : settings_) {
    if (control == CameraControl::kExposure)
      controls.set(lc::controls::ExposureTime, static_cast<std::int32_t>(value * 1e6));
    if (control == CameraControl::kGain)
      controls.set(lc::controls::AnalogueGain, static_cast<float>(value));
    if (known.find(&lc::controls::AeEnable) != known.end())
      controls.set(lc::controls::AeEnable, false);
  }
}

Result<void> LibcameraCamera::start(FrameSink sink) {
  if (thread_.runs()) return Error{ErrorCode::kUsage, info_.uri + ": the camera runs already"};
  if (!camera_) MIXRIG_TRY(take_hold());
  MIXRIG_TRY(start_stream());
  sink_ = std::move(sink);
  {
    const std::lock_guard lock(mutex_);
    count_.health.state = DeviceState::kStreaming;
    count_.begin();
  }
  thread_.start([this] { work(); });
  return {};
}

Result<void> LibcameraCamera::start_stream() {
  lc::ControlList controls(camera_->controls());
  {
    const std::lock_guard lock(mutex_);
    put_settings(controls);
  }
  const auto& known = camera_->controls();
  if (request_.rate_hz > 0 && known.find(&lc::controls::FrameDurationLimits) != known.end()) {
    const auto us = static_cast<std::int64_t>(1e6 / request_.rate_hz);
    controls.set(lc::controls::FrameDurationLimits, lc::Span<const std::int64_t, 2>({us, us}));
  }
  if (const int code = camera_->start(&controls); code != 0) return failed("starting it", code);
  for (const auto& request : requests_) {
    request->reuse(lc::Request::ReuseBuffers);
    if (const int code = camera_->queueRequest(request.get()); code != 0) {
      end_stream();
      return failed("queueing a request", code);
    }
  }
  return {};
}

/// Waits until the library has given back every request.
void LibcameraCamera::end_stream() {
  if (camera_) camera_->stop();
  const std::lock_guard lock(done_mutex_);
  done_.clear();
}

/// Leaves everything of a camera that has fallen silent as it is until the process ends. The
/// library reports only of USB cameras that they have vanished, and ends the process where another
/// camera that has vanished is stopped.
void LibcameraCamera::abandon() {
  struct Left {
    std::shared_ptr<lc::CameraManager> manager;
    std::shared_ptr<lc::Camera> camera;
    std::unique_ptr<lc::CameraConfiguration> configuration;
    std::unique_ptr<lc::FrameBufferAllocator> allocator;
    std::vector<std::unique_ptr<lc::Request>> requests;
  };
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  static auto& left = *new std::vector<Left>;  // never destroyed
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  left.push_back({manager_, std::exchange(camera_, nullptr), std::move(configuration_),
                  std::move(allocator_), std::move(requests_)});
  requests_.clear();
}

void LibcameraCamera::stop() {
  if (!thread_.stop()) return;
  if (silent_)
    abandon();
  else
    end_stream();
  const std::lock_guard lock(mutex_);
  count_.health.state = DeviceState::kStopped;
}

/// Queues a finished request. Called on the library's thread.
void LibcameraCamera::completed(lc::Request* request) {
  const std::lock_guard lock(done_mutex_);
  done_.push_back(request);
  done_changed_.notify_one();
}

/// A camera that gives no picture is lost until it gives one.
void LibcameraCamera::note_silence(bool frame) {
  const HostTime now = clock_.now();
  if (frame) last_frame_ = now;
  const bool silent = now - last_frame_ > kLibcameraSilence;
  if (silent == std::exchange(silent_, silent)) return;
  const std::lock_guard lock(mutex_);
  if (silent)
    count_.health.state = DeviceState::kLost;
  else
    count_.come_back();
}

void LibcameraCamera::work() {
  last_frame_ = clock_.now(), silent_ = false;
  while (!thread_.stopping()) {
    lc::Request* request = nullptr;
    {
      std::unique_lock lock(done_mutex_);
      done_changed_.wait_for(lock, kLibcameraWait, [this] { return !done_.empty(); });
      if (!done_.empty()) request = done_.front(), done_.pop_front();
    }
    const bool frame = request != nullptr && request->status() == lc::Request::RequestComplete;
    if (gone_) {
      come_back();
      last_frame_ = clock_.now(), silent_ = false;
      continue;
    }
    note_silence(frame);
    if (frame) {
      take(request);
      request->reuse(lc::Request::ReuseBuffers);
      {
        const std::lock_guard lock(mutex_);
        put_settings(request->controls());
      }
      (void)camera_->queueRequest(request);  // fails where it vanished: gone_ follows
    }
  }
}

void LibcameraCamera::take(lc::Request* request) {
  const lc::FrameBuffer* buffer = request->findBuffer(configuration_->at(0).stream());
  const auto mapped = maps_.find(buffer);
  if (mapped == maps_.end()) return;
  const lc::FrameMetadata& about = buffer->metadata();
  const V4l2Bytes bytes = mapped->second.filled(about.planes());
  Frame frame{
      .format = layout_.format,
      .size = layout_.size,
      .stride_bytes = layout_.stride_bytes,
      .sequence = about.sequence,
      .device_time = DeviceTime(Duration(static_cast<std::int64_t>(about.timestamp))),
      .received = clock_.now(),
      .flags = payload_flags(layout_, bytes, about.status != lc::FrameMetadata::FrameSuccess)};
  if (const auto us = request->metadata().get(lc::controls::ExposureTime))
    frame.exposure = std::chrono::microseconds(*us);
  auto draft = pool_->take();
  {
    const std::lock_guard lock(mutex_);
    if (!count_.count(frame, static_cast<bool>(draft))) return;
  }
  const std::size_t used = copy_v4l2_picture(layout_, bytes, draft.bytes());
  sink_(std::move(draft).publish(frame, used));
}

/// Waits until the camera is plugged in again.
void LibcameraCamera::come_back() {
  {
    const std::lock_guard lock(mutex_);
    count_.health.state = DeviceState::kLost;
  }
  end_stream();
  let_go();
  thread_.find_again("libcamera", info_.uri, [this] {
    if (!take_hold()) return false;
    if (!start_stream()) {
      let_go();
      return false;
    }
    const std::lock_guard lock(mutex_);
    count_.come_back();
    return true;
  });
}

Result<void> LibcameraCamera::set(CameraControl control, double value) {
  const std::string what = info_.uri + ": " + std::string(name(control));
  for (const ControlRange& range : info_.controls) {
    if (range.control != control) continue;
    if (!(value >= range.minimum && value <= range.maximum))
      return Error{ErrorCode::kUsage, what + " must be " + std::to_string(range.minimum) + " to " +
                                          std::to_string(range.maximum)};
    const std::lock_guard lock(mutex_);
    settings_[control] = value;
    return {};
  }
  return Error{ErrorCode::kUnsupported, what + " is not on this camera"};
}

/// Value that was last set: libcamera reports the value in force only with each picture.
Result<double> LibcameraCamera::get(CameraControl control) {
  const std::lock_guard lock(mutex_);
  const auto known = settings_.find(control);
  if (known != settings_.end()) return known->second;
  return Error{ErrorCode::kUnsupported,
               info_.uri + ": " + std::string(name(control)) + " is not known before it is set"};
}

StreamHealth LibcameraCamera::health() const {
  const std::lock_guard lock(mutex_);
  return count_.health;
}

}  // namespace

Result<std::unique_ptr<Camera>> open_libcamera(const std::string& id, const StreamRequest& request,
                                               Clock& clock) {
  if (request.hardware_trigger)
    return Error{ErrorCode::kUnsupported,
                 "libcamera:" + id + ": libcamera has no trigger input: leave out trigger_line"};
  auto camera = std::make_unique<LibcameraCamera>(id, request, clock);
  MIXRIG_TRY(camera->open());
  return std::unique_ptr<Camera>(std::move(camera));
}

std::vector<std::string> list_libcamera() {
  std::vector<std::string> ids;
  const auto manager = libcamera_manager();
  if (!manager) return ids;
  for (const auto& camera : (*manager)->cameras()) ids.push_back(camera->id());
  return ids;
}

}  // namespace mixrig::device
