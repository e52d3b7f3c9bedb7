// SPDX-License-Identifier: Apache-2.0
#include "extras/kinect2/kinect2_camera.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "extras/kinect2/kinect2_link.h"
#include "extras/kinect2/kinect2_protocol.h"
#include "hal/base/log.h"
#include "hal/device/frame_pool.h"
#include "hal/device/stream_count.h"

namespace mixrig::device {
namespace {

constexpr int kKinectBuffers = 10;
constexpr Duration kKinectWait = std::chrono::milliseconds(100);
constexpr Duration kKinectSilence = std::chrono::seconds(1);
constexpr std::uint8_t kColorIn = 0x83, kInfraredIn = 0x84;
constexpr std::array<StreamPipe, 2> kPipes{StreamPipe{kInfraredIn, true, 60, 8, 0x8400},
                                           StreamPipe{kColorIn, false, 20, 1, 0x4000}};
}  // namespace

/// One of the two streams.
struct KinectStream {
  FrameSink sink;  ///< empty: not started
  StreamCount count;
};

class Kinect2 {
 public:
  Kinect2(std::unique_ptr<UsbStreams> usb, std::string uri, Clock& clock)
      : usb_(std::move(usb)),
        uri_(std::move(uri)),
        clock_(clock),
        link_(*usb_, uri_, clock),
        thread_(clock) {}
  Result<void> open(const MakeRawDepthDecoder& make);

  Result<void> start(bool depth, FrameSink sink);
  void stop(bool depth);
  StreamHealth health(bool depth) const;
  DepthHealth depth_health() const;
  const CameraInfo& info(bool depth) const { return depth ? depth_info_ : color_info_; }
  const DepthInfo& steps() const { return decoder_->depth(); }

 private:
  Result<void> begin_stream();
  void work();
  void recover(BulkState state);
  void take(const StreamPacket& packet);
  void publish_depth(const Kinect2RawFrame& raw);
  void publish_color(const Kinect2ColorPacket& packet);
  DeviceTime time_of(std::uint32_t ticks);
  void set_state(DeviceState state);

  std::unique_ptr<UsbStreams> usb_;
  std::string uri_;
  Clock& clock_;
  Kinect2Link link_;
  CameraInfo depth_info_, color_info_;
  std::unique_ptr<RawDepthDecoder> decoder_;
  Kinect2DepthStream depth_stream_;
  Kinect2ColorStream color_stream_;
  FramePool depth_pool_{kKinectBuffers, 2 * kKinect2Depth.area(), 2 * kKinect2Depth.area(),
                        2 * kKinect2Depth.area()};
  FramePool color_pool_{kKinectBuffers, kKinect2MostColor};
  bool streams_ = false;
  HostTime last_bytes_at_{}, now_{};
  std::optional<std::uint64_t> ticks_;
  std::mutex control_;        ///< start and stop of the two cameras
  mutable std::mutex mutex_;  ///< guards what the cameras share with the thread
  KinectStream depth_, color_;
  DepthHealth depth_health_;
  std::uint64_t stalls_ = 0;
  DriverThread thread_;
};

Result<void> Kinect2::open(const MakeRawDepthDecoder& make) {
  MIXRIG_ASSIGN(const Kinect2Description told, link_.describe());
  depth_info_.uri = uri_;
  depth_info_.model = "Kinect v2, firmware " + told.firmware;
  depth_info_.serial = told.serial;
  depth_info_.rate_hz = 30;
  depth_info_.stamp_clock = StampClock::kDevice;
  depth_info_.usb_vendor = 0x045E;
  color_info_ = depth_info_;
  depth_info_.size = kKinect2Depth, depth_info_.format = PixelFormat::kDepth16;
  color_info_.uri += "/color";
  color_info_.size = kKinect2Color, color_info_.format = PixelFormat::kMjpeg;
  color_info_.mirrored = true;
  decoder_ = make(told.infrared, told.offsets);
  return {};
}

Result<void> Kinect2::begin_stream() {
  depth_stream_.restart();
  color_stream_.restart();
  ticks_.reset();
  {
    const std::lock_guard lock(mutex_);
    depth_.count.begin(), color_.count.begin();
  }
  MIXRIG_TRY(link_.begin());
  MIXRIG_TRY(usb_->submit(kPipes));
  last_bytes_at_ = clock_.now();
  streams_ = false;
  return {};
}

Result<void> Kinect2::start(bool depth, FrameSink sink) {
  const std::lock_guard control(control_);
  KinectStream& stream = depth ? depth_ : color_;
  if (stream.sink) return Error{ErrorCode::kUsage, info(depth).uri + ": the camera runs already"};
  if (!thread_.runs()) {
    MIXRIG_TRY(begin_stream());
    thread_.start([this] { work(); });
  }
  const std::lock_guard lock(mutex_);
  stream.sink = std::move(sink);
  stream.count.health.state = DeviceState::kStreaming;
  return {};
}

void Kinect2::stop(bool depth) {
  const std::lock_guard control(control_);
  bool last = false;
  {
    const std::lock_guard lock(mutex_);
    KinectStream& stream = depth ? depth_ : color_;
    if (!stream.sink) return;
    stream.sink = nullptr;
    stream.count.health.state = DeviceState::kStopped;
    last = !depth_.sink && !color_.sink;
  }
  if (last) thread_.stop();
}

void Kinect2::work() {
  const StreamSink sink = [this](const StreamPacket& packet) { take(packet); };
  while (!thread_.stopping()) {
    BulkState state = usb_->pump(kKinectWait, sink);
    if (state == BulkState::kFlowing && streams_ && clock_.now() - last_bytes_at_ > kKinectSilence)
      state = BulkState::kStalled;
    if (state != BulkState::kFlowing) recover(state);
  }
  usb_->cancel();
  link_.end();
}

void Kinect2::recover(BulkState state) {
  set_state(DeviceState::kLost);
  usb_->cancel();
  usb_->close();
  const auto again = [this] {
    if (!begin_stream()) {
      usb_->close();
      return false;
    }
    const std::lock_guard lock(mutex_);
    for (KinectStream* stream : {&depth_, &color_})
      if (stream->sink) stream->count.come_back();
    return true;
  };
  if (state == BulkState::kStalled) {
    log_warning("usb", uri_ + ": stalled; starting it again");
    {
      const std::lock_guard lock(mutex_);
      ++stalls_;
    }
    if (again()) return;
  }
  thread_.find_again("usb", uri_, again);
}

void Kinect2::set_state(DeviceState state) {
  const std::lock_guard lock(mutex_);
  for (KinectStream* stream : {&depth_, &color_})
    if (stream->sink) stream->count.health.state = state;
}

/// A sink runs under the lock: stop() returns after its last call.
void Kinect2::take(const StreamPacket& packet) {
  const std::lock_guard lock(mutex_);
  now_ = clock_.now();
  if (!packet.bytes.empty()) last_bytes_at_ = now_, streams_ = true;
  if (packet.endpoint == kInfraredIn && depth_.sink)
    depth_stream_.feed(packet.bytes, packet.good,
                       [this](const Kinect2RawFrame& raw) { publish_depth(raw); });
  if (packet.endpoint == kColorIn && color_.sink)
    color_stream_.feed(packet.bytes, [this](const Kinect2ColorPacket& c) { publish_color(c); });
  depth_.count.health.link_errors = depth_stream_.link_errors();
  color_.count.health.link_errors = color_stream_.link_errors();
}

/// Ticks of 0.125 ms that wrap after 149 hours, on one time line for both streams.
DeviceTime Kinect2::time_of(std::uint32_t ticks) {
  const auto ahead =
      static_cast<std::int32_t>(ticks - static_cast<std::uint32_t>(ticks_.value_or(ticks)));
  const auto base = static_cast<std::int64_t>(ticks_.value_or(ticks));
  const std::int64_t at = std::max<std::int64_t>(0, base + ahead);
  ticks_ = static_cast<std::uint64_t>(at);
  return DeviceTime(std::chrono::microseconds(125 * at));
}

void Kinect2::publish_depth(const Kinect2RawFrame& raw) {
  Frame frame{.format = PixelFormat::kDepth16,
              .size = kKinect2Depth,
              .stride_bytes = 2 * static_cast<std::size_t>(kKinect2Depth.width),
              .sequence = raw.frame,
              .device_time = time_of(raw.ticks),
              .received = now_};
  if (!raw.whole) frame.flags |= kFrameIncomplete;
  FramePool::Draft draft = depth_pool_.take();
  if (!depth_.count.count(frame, static_cast<bool>(draft))) return;
  if (raw.whole) {
    decoder_->decode(raw.pictures, draft.bytes(), draft.amplitude(), draft.confidence());
  } else {
    for (const auto part : {draft.bytes(), draft.amplitude(), draft.confidence()})
      std::fill(part.begin(), part.end(), std::uint8_t{0});
  }
  std::uint64_t sum = 0;
  const auto amplitude = draft.amplitude();
  for (std::size_t i = 0; i + 1 < amplitude.size(); i += 2)
    sum += static_cast<std::uint64_t>(amplitude[i] | amplitude[i + 1] << 8);
  depth_health_.mean_amplitude =
      static_cast<double>(sum) / static_cast<double>(kKinect2Depth.area());
  constexpr std::size_t kBytes = std::size_t{2} * 512 * 424;
  depth_.sink(std::move(draft).publish(frame, kBytes, kBytes, kBytes));
}

void Kinect2::publish_color(const Kinect2ColorPacket& packet) {
  Frame frame{.format = PixelFormat::kMjpeg,
              .size = kKinect2Color,
              .sequence = packet.frame,
              .device_time = time_of(packet.ticks),
              .received = now_,
              .exposure = Duration(static_cast<std::int64_t>(1e6 * packet.exposure_ms))};
  FramePool::Draft draft = color_pool_.take();
  if (!color_.count.count(frame, static_cast<bool>(draft))) return;
  std::copy(packet.jpeg.begin(), packet.jpeg.end(), draft.bytes().begin());
  color_.sink(std::move(draft).publish(frame, packet.jpeg.size()));
}

StreamHealth Kinect2::health(bool depth) const {
  const std::lock_guard lock(mutex_);
  StreamHealth health = depth ? depth_.count.health : color_.count.health;
  health.link_errors += stalls_;
  return health;
}

DepthHealth Kinect2::depth_health() const {
  const std::lock_guard lock(mutex_);
  return depth_health_;
}

namespace {

class Kinect2Depth final : public DepthCamera {
 public:
  explicit Kinect2Depth(std::shared_ptr<Kinect2> device) : device_(std::move(device)) {}
  ~Kinect2Depth() override { device_->stop(true); }
  const CameraInfo& info() const override { return device_->info(true); }
  const DepthInfo& depth() const override { return device_->steps(); }
  Result<void> start(FrameSink sink) override { return device_->start(true, std::move(sink)); }
  void stop() override { device_->stop(true); }
  StreamHealth health() const override { return device_->health(true); }
  DepthHealth depth_health() const override { return device_->depth_health(); }

 private:
  std::shared_ptr<Kinect2> device_;
};

class Kinect2Color final : public Camera {
 public:
  explicit Kinect2Color(std::shared_ptr<Kinect2> device) : device_(std::move(device)) {}
  ~Kinect2Color() override { device_->stop(false); }
  const CameraInfo& info() const override { return device_->info(false); }
  Result<void> start(FrameSink sink) override { return device_->start(false, std::move(sink)); }
  void stop() override { device_->stop(false); }
  Result<void> set(CameraControl control, double) override { return no_control(control); }
  Result<double> get(CameraControl control) override { return no_control(control); }
  StreamHealth health() const override { return device_->health(false); }

 private:
  Error no_control(CameraControl control) const {
    return Error{ErrorCode::kUnsupported, info().uri + ": " + std::string(name(control)) +
                                              " cannot be set, the camera controls it itself: "
                                              "leave it out of rig.toml"};
  }
  std::shared_ptr<Kinect2> device_;
};

}  // namespace

Result<std::shared_ptr<Kinect2>> open_kinect2(std::unique_ptr<UsbStreams> usb, std::string uri,
                                              Clock& clock, const MakeRawDepthDecoder& make) {
  auto device = std::make_shared<Kinect2>(std::move(usb), std::move(uri), clock);
  MIXRIG_TRY(device->open(make));
  return device;
}

std::unique_ptr<DepthCamera> kinect2_depth_camera(std::shared_ptr<Kinect2> device) {
  return std::make_unique<Kinect2Depth>(std::move(device));
}

std::unique_ptr<Camera> kinect2_color_camera(std::shared_ptr<Kinect2> device) {
  return std::make_unique<Kinect2Color>(std::move(device));
}

}  // namespace mixrig::device
