// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/aravis/aravis_camera.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include <arv.h>

#include "hal/device/frame_pool.h"
#include "hal/device/stream_count.h"
#include "hal/linux/aravis/aravis_chunks.h"
#include "hal/linux/aravis/aravis_setup.h"
#include "hal/wire/camera/genicam_buffer.h"

namespace mixrig::device {
namespace {

constexpr int kLibraryBuffers = 8, kBuffers = 10;
constexpr std::size_t kMostParts = 8;
constexpr int kSocketBuffer_bytes = 16 << 20;  // the kernel gives at most net.core.rmem_max
constexpr guint64 kWait_us = 100000;

template <typename T>
struct Unref {
  void operator()(T* object) const { g_object_unref(object); }
};
template <typename T>
using Object = std::unique_ptr<T, Unref<T>>;

class AravisCamera final : public Camera {
 public:
  AravisCamera(std::string id, const StreamRequest& request, bool depth, Clock& clock)
      : id_(std::move(id)), request_(request), depth_(depth), clock_(clock), thread_(clock) {
    info_.uri = "aravis:" + id_;
  }
  ~AravisCamera() override { stop(); }
  Result<void> open();
  const DepthInfo& depth_info() const { return described_.steps; }

  const CameraInfo& info() const override { return info_; }
  Result<void> start(FrameSink sink) override;
  void stop() override;
  Result<void> set(CameraControl control, double value) override;
  Result<double> get(CameraControl control) override;
  StreamHealth health() const override;

 private:
  Result<void> connect();
  Result<void> set_up();
  Result<void> apply(CameraControl control, double value);
  Result<void> start_stream();
  void close_stream();
  void work();
  void take(ArvBuffer* buffer);
  DepthUsed copy(ArvBuffer* buffer, const FramePool::Draft& draft) const;
  void come_back();
  Error failed(const std::string& what, const AravisFault& fault) const {
    return fault.error(info_.uri, what);
  }

  std::string id_;
  StreamRequest request_;
  const bool depth_;
  AravisDepth described_;  ///< used by a depth camera only
  Clock& clock_;
  CameraInfo info_;
  std::uint32_t code_ = 0;
  Object<ArvCamera> camera_;
  Object<ArvStream> stream_;
  AravisChunks chunks_;
  Object<ArvChunkParser> parser_;  ///< parses chunks_; for the driver's thread
  std::optional<FramePool> pool_;
  FrameSink sink_;
  std::atomic<bool> gone_ = false;
  mutable std::mutex mutex_;  ///< guards count_ and camera_ against set/get
  StreamCount count_;
  std::map<CameraControl, double> settings_;
  DriverThread thread_;
};

Result<void> AravisCamera::open() {
  MIXRIG_TRY(connect());
  MIXRIG_TRY(set_up());
  describe_aravis(camera_.get(), info_);
  info_.stamp_clock = StampClock::kDevice;
  const std::size_t bytes =
      image_bytes(info_.format, info_.size, row_bytes(info_.format, info_.size.width));
  const std::size_t map_bytes = depth_ ? bytes : 0;
  pool_.emplace(kBuffers, bytes, map_bytes, map_bytes);
  return {};
}

Result<void> AravisCamera::connect() {
  AravisFault fault;
  arv_update_device_list();
  camera_.reset(arv_camera_new(id_.c_str(), fault));
  if (!camera_)
    return Error{
        ErrorCode::kNotFound,
        info_.uri + ": no such camera: see arv-tool-0.8 and the network (" + fault.text() + ")"};
  ArvDevice* device = arv_camera_get_device(camera_.get());
  // The packet socket needs CAP_NET_RAW and receives nothing on the loopback interface.
  if (ARV_IS_GV_DEVICE(device))
    arv_gv_device_set_stream_options(ARV_GV_DEVICE(device),
                                     ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  gone_ = false;
  g_signal_connect(device, "control-lost",
                   G_CALLBACK(+[](ArvDevice*, std::atomic<bool>* gone) { *gone = true; }), &gone_);
  return {};
}

Result<void> AravisCamera::set_up() {
  CameraInfo described = info_;
  MIXRIG_ASSIGN(const std::uint32_t code,
                depth_ ? choose_aravis_depth(camera_.get(), request_, described)
                       : choose_aravis_format(camera_.get(), request_, described));
  if (depth_) {
    MIXRIG_ASSIGN(described_, aravis_depth_info(camera_.get(), info_.uri, code));
  }
  MIXRIG_TRY(choose_aravis_trigger(camera_.get(), request_, described));
  if (pool_ && (code != code_ || described.size != info_.size))
    return Error{
        ErrorCode::kDevice,
        info_.uri +
            ": a different camera was plugged in: plug the first one in again, or restart mixrig"};
  chunks_ = choose_aravis_chunks(camera_.get());
  parser_.reset(chunks_.any() ? arv_camera_create_chunk_parser(camera_.get()) : nullptr);
  for (const auto& [control, value] : settings_) MIXRIG_TRY(apply(control, value));
  code_ = code;
  if (!pool_) info_ = described;  // callers hold references to it: not changed after open()
  return {};
}

Result<void> AravisCamera::start(FrameSink sink) {
  if (thread_.runs()) return Error{ErrorCode::kUsage, info_.uri + ": the camera runs already"};
  sink_ = std::move(sink);
  MIXRIG_TRY(start_stream());
  {
    const std::lock_guard lock(mutex_);
    count_.health.state = DeviceState::kStreaming;
    count_.begin();
  }
  thread_.start([this] { work(); });
  return {};
}

Result<void> AravisCamera::start_stream() {
  AravisFault fault;
  stream_.reset(arv_camera_create_stream(camera_.get(), nullptr, nullptr, fault));
  if (!stream_) return failed("creating the stream", fault);
  if (ARV_IS_GV_STREAM(stream_.get()))
    // The library's default, one picture's payload, ignores the kernel's overhead per packet:
    // small pictures then lose packets where reader and network share a core.
    g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED,
                 "socket-buffer-size", kSocketBuffer_bytes, nullptr);
  const guint payload = arv_camera_get_payload(camera_.get(), fault);
  if (fault.any()) return failed("reading the payload size", fault);
  const auto bytes = std::max<std::size_t>(payload, declared_bytes(code_, info_.size));
  for (int i = 0; i < kLibraryBuffers; ++i)
    arv_stream_push_buffer(stream_.get(), arv_buffer_new_allocate(bytes));
  arv_camera_start_acquisition(camera_.get(), fault);
  if (fault.any()) {
    stream_.reset();
    return failed("starting the acquisition", fault);
  }
  return {};
}

void AravisCamera::close_stream() {
  AravisFault fault;
  if (camera_ && !gone_) arv_camera_stop_acquisition(camera_.get(), fault);
  stream_.reset();
}

void AravisCamera::stop() {
  if (!thread_.stop()) return;
  close_stream();
  const std::lock_guard lock(mutex_);
  count_.health.state = DeviceState::kStopped;
}

void AravisCamera::work() {
  while (!thread_.stopping()) {
    if (ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_.get(), kWait_us)) {
      take(buffer);
      arv_stream_push_buffer(stream_.get(), buffer);
    } else if (gone_) {
      come_back();
    }
  }
}

/// Copies the picture, or the maps of a depth frame; nothing if the buffer does not hold it.
DepthUsed AravisCamera::copy(ArvBuffer* buffer, const FramePool::Draft& draft) const {
  std::size_t bytes = 0;
  if (!depth_) {
    const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &bytes));
    return {.depth = copy_picture(code_, info_.size, {data, bytes}, draft.bytes())
                         ? draft.bytes().size()
                         : 0};
  }
  std::array<GenicamPart, kMostParts> parts;
  std::size_t count = 0;
  if (arv_buffer_get_payload_type(buffer) != ARV_BUFFER_PAYLOAD_TYPE_MULTIPART) {
    const auto* data = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &bytes));
    parts[count++] = {code_, info_.size, {data, bytes}};
  } else {
    const guint there = std::min<guint>(arv_buffer_get_n_parts(buffer), kMostParts);
    for (guint i = 0; i < there; ++i) {
      const auto* data =
          static_cast<const std::uint8_t*>(arv_buffer_get_part_data(buffer, i, &bytes));
      parts[count++] = {
          arv_buffer_get_part_pixel_format(buffer, i),
          {arv_buffer_get_part_width(buffer, i), arv_buffer_get_part_height(buffer, i)},
          {data, data != nullptr ? bytes : 0}};
    }
  }
  return copy_depth(std::span(parts).first(count), info_.size, described_.floats,
                    {draft.bytes(), draft.amplitude(), draft.confidence()});
}

void AravisCamera::take(ArvBuffer* buffer) {
  Frame frame{
      .format = info_.format,
      .size = info_.size,
      .stride_bytes = row_bytes(info_.format, info_.size.width),
      .sequence = arv_buffer_get_frame_id(buffer),
      .device_time = DeviceTime(Duration(arv_buffer_get_timestamp(buffer) & kMostAravisTime_ns)),
      .received = clock_.now()};
  const bool arrived = arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS;
  if (arrived && parser_) read_aravis_chunks(parser_.get(), buffer, chunks_, frame);
  auto draft = pool_->take();
  const DepthUsed used = arrived && draft ? copy(buffer, draft) : DepthUsed();
  const bool whole = used.depth > 0;
  if (!whole) frame.flags |= kFrameIncomplete;
  {
    const std::lock_guard lock(mutex_);
    if (!count_.count(frame, static_cast<bool>(draft))) return;
  }
  const std::size_t bytes = draft.bytes().size();
  sink_(std::move(draft).publish(frame, bytes, used.amplitude, used.confidence));
}

void AravisCamera::come_back() {
  {
    const std::lock_guard lock(mutex_);
    count_.health.state = DeviceState::kLost;
    stream_.reset();
    camera_.reset();
  }
  thread_.find_again("aravis", info_.uri, [this] {
    const std::lock_guard lock(mutex_);
    if (!connect() || !set_up() || !start_stream()) return false;
    count_.come_back();
    return true;
  });
}

Result<void> AravisCamera::set(CameraControl control, double value) {
  const auto range = std::find_if(info_.controls.begin(), info_.controls.end(),
                                  [&](const ControlRange& r) { return r.control == control; });
  const std::string what = info_.uri + ": " + std::string(name(control));
  if (range == info_.controls.end())
    return Error{ErrorCode::kUnsupported, what + " is not on this camera"};
  if (!(value >= range->minimum && value <= range->maximum))
    return Error{ErrorCode::kUsage, what + " must be " + std::to_string(range->minimum) + " to " +
                                        std::to_string(range->maximum)};
  const std::lock_guard lock(mutex_);
  if (!camera_)
    return Error{ErrorCode::kDevice, what + ": the camera is unplugged: plug it in again"};
  MIXRIG_TRY(apply(control, value));
  settings_[control] = value;
  return {};
}

Result<void> AravisCamera::apply(CameraControl control, double value) {
  AravisFault fault;
  if (control == CameraControl::kExposure)
    arv_camera_set_exposure_time(camera_.get(), value * 1e6, fault);
  else
    arv_camera_set_gain(camera_.get(), value, fault);
  if (fault.any()) return failed("setting " + std::string(name(control)), fault);
  return {};
}

Result<double> AravisCamera::get(CameraControl control) {
  const std::lock_guard lock(mutex_);
  AravisFault fault;
  if (!camera_)
    return Error{ErrorCode::kDevice, info_.uri + ": the camera is unplugged: plug it in again"};
  double value = 0;
  if (control == CameraControl::kExposure)
    value = arv_camera_get_exposure_time(camera_.get(), fault) * 1e-6;
  else if (control == CameraControl::kGain)
    value = arv_camera_get_gain(camera_.get(), fault);
  else
    return Error{ErrorCode::kUnsupported,
                 info_.uri + ": " + std::string(name(control)) + " is not on this camera"};
  if (fault.any()) return failed("reading " + std::string(name(control)), fault);
  return value;
}

StreamHealth AravisCamera::health() const {
  const std::lock_guard lock(mutex_);
  return count_.health;
}

Result<std::unique_ptr<AravisCamera>> open_camera(const std::string& id,
                                                  const StreamRequest& request, bool depth,
                                                  Clock& clock) {
  auto camera = std::make_unique<AravisCamera>(id, request, depth, clock);
  MIXRIG_TRY(camera->open());
  return camera;
}

}  // namespace

Result<std::unique_ptr<Camera>> open_aravis(const std::string& id, const StreamRequest& request,
                                            Clock& clock) {
  MIXRIG_ASSIGN(auto camera, open_camera(id, request, false, clock));
  return std::unique_ptr<Camera>(std::move(camera));
}

Result<std::unique_ptr<DepthCamera>> open_aravis_depth(const std::string& id,
                                                       const StreamRequest& request, Clock& clock) {
  MIXRIG_ASSIGN(auto camera, open_camera(id, request, true, clock));
  const DepthInfo depth = camera->depth_info();
  return as_depth_camera(std::move(camera), depth);
}

std::vector<std::string> list_aravis() {
  std::vector<std::string> ids;
  arv_update_device_list();
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) ids.emplace_back(arv_get_device_id(i));
  return ids;
}

}  // namespace mixrig::device
