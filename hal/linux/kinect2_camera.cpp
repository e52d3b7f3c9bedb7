// SPDX-License-Identifier: Apache-2.0
// The order of commands and requests: facts of libfreenect2 (at fd64c5d, libfreenect2.cpp and
// usb_control.cpp).
#include "hal/linux/kinect2_camera.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "hal/base/log.h"
#include "hal/device/frame_pool.h"
#include "hal/wire/kinect2_streams.h"

namespace mixrig::device {
namespace {

constexpr int kKinectBuffers = 10;
constexpr Duration kKinectWait = std::chrono::milliseconds(100);
constexpr Duration kKinectLookAgain = std::chrono::milliseconds(250);
constexpr Duration kKinectSilence = std::chrono::seconds(1);
constexpr std::uint8_t kCommandOut = 0x02, kCommandIn = 0x81, kColorIn = 0x83, kInfraredIn = 0x84;
constexpr int kInfraredInterface = 1, kStatusTries = 50;
constexpr std::uint32_t kMostPage = 0x1C0000;
constexpr std::array<StreamPipe, 2> kPipes{StreamPipe{kInfraredIn, true, 60, 8, 0x8400},
                                           StreamPipe{kColorIn, false, 20, 1, 0x4000}};
// USB 3.1: SET_ISOCH_DELAY of 40 ns; SET_FEATURE U1 and U2; FUNCTION_SUSPEND of interface 0.
constexpr UsbRequest kIsochronousDelay{0, 49, 40, 0}, kEnableU1{0, 3, 48, 0},
    kEnableU2{0, 3, 49, 0};
constexpr UsbRequest kVideoOn{1, 3, 0, 0}, kVideoOff{1, 3, 0, 0x0300};

Kinect2Request page(Kinect2Page number, std::uint32_t most, std::uint32_t least) {
  return {Kinect2Command::kPage, {static_cast<std::uint32_t>(number)}, 1, most, least};
}
Kinect2Request set_mode(std::uint32_t on, std::uint32_t value = 0) {
  return {Kinect2Command::kSetMode, {on, value}, 4};
}
const Kinect2Request kReadStatus{Kinect2Command::kStatus, {0x090000}, 1, 4, 4};

}  // namespace

/// Counter, stamps and health of one of the two streams.
struct KinectStream {
  FrameSink sink;  ///< empty: not started
  bool first = true, after_restart = false;
  std::uint32_t last = 0;
  StreamHealth health;

  void restart() { after_restart = after_restart || !first, first = true; }
  /// Sets number and flags of a frame and counts what was lost before it.
  void number(std::uint32_t frame, Frame& out) {
    out.sequence = frame;
    if (const std::uint32_t ahead = frame - last; !first && ahead > 1 && ahead < 0x80000000U) {
      out.flags |= kFrameAfterGap;
      health.lost += ahead - 1;
    }
    if (std::exchange(after_restart, false)) out.flags |= kFrameRestarted;
    first = false;
    last = frame;
  }
};

class Kinect2 {
 public:
  Kinect2(std::unique_ptr<UsbStreams> usb, std::string uri, Clock& clock)
      : usb_(std::move(usb)), uri_(std::move(uri)), clock_(clock) {}
  ~Kinect2() { stop_thread(); }
  Result<void> open(const MakeRawDepthDecoder& make);

  Result<void> start(bool depth, FrameSink sink);
  void stop(bool depth);
  StreamHealth health(bool depth) const;
  DepthHealth depth_health() const;
  const CameraInfo& info(bool depth) const { return depth ? depth_info_ : color_info_; }
  const DepthInfo& steps() const { return decoder_->depth(); }

 private:
  Result<std::vector<std::uint8_t>> ask(const Kinect2Request& request);
  Result<void> begin_stream();
  void end_stream();
  void stop_thread();
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
  CameraInfo depth_info_, color_info_;
  std::unique_ptr<RawDepthDecoder> decoder_;
  std::vector<std::uint8_t> answer_;
  std::uint32_t sequence_ = 0;
  Kinect2DepthStream depth_stream_;
  Kinect2ColorStream color_stream_;
  FramePool depth_pool_{kKinectBuffers, 2 * kKinect2Depth.area(), 2 * kKinect2Depth.area(),
                        2 * kKinect2Depth.area()};
  FramePool color_pool_{kKinectBuffers, kKinect2MostColor};
  bool streams_ = false;
  HostTime last_bytes_at_{}, now_{};
  std::optional<std::uint64_t> ticks_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  std::mutex control_;        ///< start and stop of the two cameras
  mutable std::mutex mutex_;  ///< guards what the cameras share with the thread
  KinectStream depth_, color_;
  DepthHealth depth_health_;
  std::uint64_t returns_ = 0, stalls_ = 0;
};

/// Sends a command and reads its answer and its completion.
Result<std::vector<std::uint8_t>> Kinect2::ask(const Kinect2Request& request) {
  const std::uint32_t sequence = sequence_++;
  MIXRIG_TRY(usb_->write(kCommandOut, pack_kinect2_request(request, sequence)));
  const auto failed = [&](const char* what) {
    return Error{ErrorCode::kDevice, uri_ + ": command " +
                                         std::to_string(static_cast<int>(request.command)) + " " +
                                         what + ": plug the camera in again"};
  };
  std::vector<std::uint8_t> answer;
  if (request.most_answer > 0) {
    answer.resize(request.most_answer);
    MIXRIG_ASSIGN(const std::size_t got, usb_->read(kCommandIn, answer));
    answer.resize(got);
    if (parse_kinect2_complete(answer) || got < request.least_answer)
      return failed("was answered with too little");
  }
  std::array<std::uint8_t, 16> complete{};
  MIXRIG_ASSIGN(const std::size_t got, usb_->read(kCommandIn, complete));
  const auto done = parse_kinect2_complete(std::span<const std::uint8_t>(complete).first(got));
  if (!done || *done != sequence) return failed("was not completed");
  return answer;
}

Result<void> Kinect2::open(const MakeRawDepthDecoder& make) {
  MIXRIG_TRY(usb_->open());
  MIXRIG_TRY(usb_->request(kIsochronousDelay));
  MIXRIG_TRY(usb_->set_alternate(kInfraredInterface, 0));
  MIXRIG_TRY(usb_->request(kEnableU1));
  MIXRIG_TRY(usb_->request(kEnableU2));
  MIXRIG_TRY(usb_->request(kVideoOn));
  MIXRIG_ASSIGN(auto bytes, ask({Kinect2Command::kFirmware, {}, 0, 0x200, 60}));
  MIXRIG_ASSIGN(const std::string firmware, parse_kinect2_firmware(bytes));
  MIXRIG_ASSIGN(bytes, ask(page(Kinect2Page::kSerial, 0x80, 2)));
  MIXRIG_ASSIGN(const std::string serial, parse_kinect2_serial(bytes));
  MIXRIG_ASSIGN(bytes, ask(page(Kinect2Page::kInfrared, kMostPage, 92)));
  MIXRIG_ASSIGN(const Kinect2Infrared infrared, parse_kinect2_infrared(bytes));
  MIXRIG_ASSIGN(bytes, ask(page(Kinect2Page::kPhaseOffsets, kMostPage, 1302572)));
  MIXRIG_ASSIGN(const Kinect2Offsets offsets, parse_kinect2_offsets(bytes));
  MIXRIG_TRY(usb_->request(kVideoOff));
  depth_info_.uri = uri_;
  depth_info_.model = "Kinect v2, firmware " + firmware;
  depth_info_.serial = serial;
  depth_info_.rate_hz = 30;
  depth_info_.stamp_clock = StampClock::kDevice;
  depth_info_.usb_vendor = 0x045E;
  color_info_ = depth_info_;
  depth_info_.size = kKinect2Depth, depth_info_.format = PixelFormat::kDepth16;
  color_info_.uri += "/color";
  color_info_.size = kKinect2Color, color_info_.format = PixelFormat::kMjpeg;
  color_info_.mirrored = true;
  decoder_ = make(infrared, offsets);
  return {};
}

Result<void> Kinect2::begin_stream() {
  depth_stream_.restart();
  color_stream_.restart();
  ticks_.reset();
  {
    const std::lock_guard lock(mutex_);
    depth_.restart(), color_.restart();
  }
  MIXRIG_TRY(usb_->open());
  MIXRIG_TRY(usb_->request(kVideoOn));
  MIXRIG_TRY(ask(set_mode(1, 0x00640064)));
  MIXRIG_TRY(ask(set_mode(0)));
  bool ready = false;
  for (int i = 0; i < kStatusTries && !ready; ++i) {
    MIXRIG_ASSIGN(const auto bytes, ask(kReadStatus));
    MIXRIG_ASSIGN(const std::uint32_t status, parse_kinect2_status(bytes));
    ready = (status & 1) != 0;
    if (!ready) clock_.sleep_until(clock_.now() + kKinectWait);
  }
  if (!ready)
    return Error{ErrorCode::kDevice, uri_ + ": does not get ready: check its power supply"};
  MIXRIG_TRY(ask({Kinect2Command::kInitStreams}));
  MIXRIG_TRY(usb_->set_alternate(kInfraredInterface, 1));
  MIXRIG_TRY(ask(kReadStatus));
  MIXRIG_TRY(ask({Kinect2Command::kSetStreaming, {1}, 1}));
  MIXRIG_TRY(usb_->submit(kPipes));
  last_bytes_at_ = clock_.now();
  streams_ = false;
  return {};
}

void Kinect2::end_stream() {
  usb_->cancel();
  (void)usb_->set_alternate(kInfraredInterface, 0);
  for (const Kinect2Request& request :
       {set_mode(1, 0x00640064), set_mode(0), Kinect2Request{Kinect2Command::kStop},
        Kinect2Request{Kinect2Command::kSetStreaming, {0}, 1}, set_mode(1), set_mode(0)})
    if (!ask(request)) break;
  (void)usb_->request(kVideoOff);
}

Result<void> Kinect2::start(bool depth, FrameSink sink) {
  const std::lock_guard control(control_);
  KinectStream& stream = depth ? depth_ : color_;
  if (stream.sink) return Error{ErrorCode::kUsage, info(depth).uri + ": the camera runs already"};
  if (!thread_.joinable()) {
    MIXRIG_TRY(begin_stream());
    stop_ = false;
    thread_ = std::thread([this] { work(); });
  }
  const std::lock_guard lock(mutex_);
  stream.sink = std::move(sink);
  stream.health.state = DeviceState::kStreaming;
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
    stream.health.state = DeviceState::kStopped;
    last = !depth_.sink && !color_.sink;
  }
  if (last) stop_thread();
}

void Kinect2::stop_thread() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void Kinect2::work() {
  const StreamSink sink = [this](const StreamPacket& packet) { take(packet); };
  while (!stop_) {
    BulkState state = usb_->pump(kKinectWait, sink);
    if (state == BulkState::kFlowing && streams_ && clock_.now() - last_bytes_at_ > kKinectSilence)
      state = BulkState::kStalled;
    if (state != BulkState::kFlowing) recover(state);
  }
  end_stream();
}

void Kinect2::recover(BulkState state) {
  set_state(DeviceState::kLost);
  log_warning("usb", uri_ + (state == BulkState::kGone ? ": lost; looking for it"
                                                       : ": stalled; starting it again"));
  if (state == BulkState::kStalled) {
    const std::lock_guard lock(mutex_);
    ++stalls_;
  }
  usb_->cancel();
  usb_->close();
  while (!stop_) {
    if (begin_stream()) {
      {
        const std::lock_guard lock(mutex_);
        ++returns_;
      }
      return set_state(DeviceState::kStreaming);
    }
    usb_->close();
    clock_.sleep_until(clock_.now() + kKinectLookAgain);
  }
}

void Kinect2::set_state(DeviceState state) {
  const std::lock_guard lock(mutex_);
  for (KinectStream* stream : {&depth_, &color_})
    if (stream->sink) stream->health.state = state;
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
  depth_.health.link_errors = depth_stream_.link_errors();
  color_.health.link_errors = color_stream_.link_errors();
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
              .device_time = time_of(raw.ticks),
              .received = now_};
  depth_.number(raw.frame, frame);
  if (!raw.whole) frame.flags |= kFrameIncomplete, ++depth_.health.incomplete;
  FramePool::Draft draft = depth_pool_.take();
  if (!draft) return void(++depth_.health.overrun);
  if (raw.whole) {
    decoder_->decode(raw.pictures, draft.bytes(), draft.amplitude(), draft.confidence());
  } else {
    for (const auto part : {draft.bytes(), draft.amplitude(), draft.confidence()})
      std::fill(part.begin(), part.end(), std::uint8_t{0});
  }
  ++depth_.health.frames;
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
              .device_time = time_of(packet.ticks),
              .received = now_,
              .exposure = Duration(static_cast<std::int64_t>(1e6 * packet.exposure_ms))};
  color_.number(packet.frame, frame);
  FramePool::Draft draft = color_pool_.take();
  if (!draft) return void(++color_.health.overrun);
  std::copy(packet.jpeg.begin(), packet.jpeg.end(), draft.bytes().begin());
  ++color_.health.frames;
  color_.sink(std::move(draft).publish(frame, packet.jpeg.size()));
}

StreamHealth Kinect2::health(bool depth) const {
  const std::lock_guard lock(mutex_);
  StreamHealth health = depth ? depth_.health : color_.health;
  health.returns = returns_;
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
