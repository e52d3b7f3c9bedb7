// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/tof_usb_camera.h"

#include <array>
#include <atomic>
#include <charconv>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "hal/device/stream_count.h"
#include "hal/linux/libusb_bulk.h"
#include "hal/wire/camera/tof_usb_decoder.h"

namespace mixrig::device {
namespace {

constexpr int kTofBuffers = 10;
constexpr Duration kTofWait = std::chrono::milliseconds(100);
constexpr Duration kTofLookAgain = std::chrono::milliseconds(250);
constexpr Duration kSilence = std::chrono::seconds(1);
constexpr std::uint8_t kSubclass = 0x54, kProtocol = 0x01, kDescribe = 0x10, kStream = 0x11;

class TofUsbCamera final : public DepthCamera {
 public:
  TofUsbCamera(std::unique_ptr<UsbBulk> pipe, std::string uri, Clock& clock)
      : pipe_(std::move(pipe)), clock_(clock) {
    info_.uri = std::move(uri);
  }
  ~TofUsbCamera() override { stop(); }
  Result<void> open();

  const CameraInfo& info() const override { return info_; }
  const DepthInfo& depth() const override { return description_.depth; }
  Result<void> start(FrameSink sink) override;
  void stop() override;
  StreamHealth health() const override;
  DepthHealth depth_health() const override;

 private:
  Result<TofDescription> describe();
  Result<void> start_stream();
  void work();
  void recover(BulkState state);
  void publish_health(DeviceState state);

  std::unique_ptr<UsbBulk> pipe_;
  Clock& clock_;
  CameraInfo info_;
  TofDescription description_;
  HostTime last_bytes_at_{};
  bool streams_ = false;  ///< bytes arrived since the stream was started
  std::optional<FramePool> pool_;
  std::optional<TofUsbDecoder> decoder_;
  FrameSink sink_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  ///< guards what health() reads
  StreamHealth health_;
  DepthHealth depth_health_;
  std::uint64_t returns_ = 0, stalls_ = 0;
};

Result<void> TofUsbCamera::open() {
  MIXRIG_TRY(pipe_->open());
  MIXRIG_ASSIGN(description_, describe());
  info_.model = "USB ToF";
  info_.size = description_.size;
  info_.format = PixelFormat::kDepth16;
  info_.rate_hz = description_.rate_hz;
  info_.stamp_clock = StampClock::kDevice;
  const std::size_t bytes = description_.size.area() * 2;
  pool_.emplace(kTofBuffers, bytes, description_.amplitude ? bytes : 0);
  decoder_.emplace(description_, *pool_);
  return {};
}

Result<TofDescription> TofUsbCamera::describe() {
  std::array<std::uint8_t, kTofDescriptionBytes> bytes{};
  MIXRIG_ASSIGN(const std::size_t got, pipe_->request(kDescribe, 0, bytes));
  return parse_tof_description(std::span<const std::uint8_t>(bytes).first(got));
}

Result<void> TofUsbCamera::start_stream() {
  decoder_->restart();
  MIXRIG_TRY(pipe_->submit());
  const auto started = pipe_->request(kStream, 1, {});
  last_bytes_at_ = clock_.now();
  streams_ = false;
  if (started) return {};
  pipe_->cancel();
  return started.error();
}

Result<void> TofUsbCamera::start(FrameSink sink) {
  if (thread_.joinable()) return Error{ErrorCode::kUsage, info_.uri + ": the camera runs already"};
  MIXRIG_TRY(pipe_->open());
  sink_ = std::move(sink);
  MIXRIG_TRY(start_stream());
  publish_health(DeviceState::kStreaming);
  stop_ = false;
  thread_ = guarded_thread(
      "usb", [this] { work(); },
      [this](const Error& error) {
        log_end_of_driver(error);
        publish_health(DeviceState::kFailed);
      });
  return {};
}

void TofUsbCamera::stop() {
  stop_ = true;
  if (!thread_.joinable()) return;
  thread_.join();
  publish_health(DeviceState::kStopped);
}

void TofUsbCamera::work() {
  const BulkSink take = [this](std::span<const std::uint8_t> bytes) {
    last_bytes_at_ = clock_.now();
    streams_ = true;
    decoder_->feed(bytes, last_bytes_at_, sink_);
  };
  while (!stop_) {
    BulkState state = pipe_->pump(kTofWait, take);
    // A camera that has not sent anything yet may be waiting for its trigger.
    if (state == BulkState::kFlowing && streams_ && clock_.now() - last_bytes_at_ > kSilence)
      state = BulkState::kStalled;
    if (state != BulkState::kFlowing)
      recover(state);
    else
      publish_health(DeviceState::kStreaming);
  }
  pipe_->cancel();
  (void)pipe_->request(kStream, 0, {});
}

/// Restarts the stream, or reopens the device, until it streams. Logged once, not per try.
void TofUsbCamera::recover(BulkState state) {
  pipe_->cancel();
  if (state == BulkState::kStalled) ++stalls_;
  publish_health(DeviceState::kLost);
  log_warning("usb", info_.uri + (state == BulkState::kGone ? ": lost; looking for it"
                                                            : ": stalled; starting it again"));
  if (state == BulkState::kGone) pipe_->close();
  while (!stop_) {
    if (pipe_->open() && start_stream()) {
      ++returns_;
      return publish_health(DeviceState::kStreaming);
    }
    pipe_->close();
    clock_.sleep_until(clock_.now() + kTofLookAgain);
  }
}

void TofUsbCamera::publish_health(DeviceState state) {
  const std::lock_guard lock(mutex_);
  health_ = decoder_->health();
  health_.state = state;
  health_.returns = returns_;
  health_.link_errors += stalls_;
  depth_health_ = decoder_->depth_health();
}

StreamHealth TofUsbCamera::health() const {
  const std::lock_guard lock(mutex_);
  return health_;
}

DepthHealth TofUsbCamera::depth_health() const {
  const std::lock_guard lock(mutex_);
  return depth_health_;
}

}  // namespace

Result<std::unique_ptr<DepthCamera>> open_tof(std::unique_ptr<UsbBulk> pipe, std::string uri,
                                              Clock& clock) {
  auto camera = std::make_unique<TofUsbCamera>(std::move(pipe), std::move(uri), clock);
  MIXRIG_TRY(camera->open());
  return std::unique_ptr<DepthCamera>(std::move(camera));
}

Result<std::unique_ptr<DepthCamera>> open_tof_usb(const std::string& id, Clock& clock) {
  BulkAddress address{.subclass = kSubclass, .protocol = kProtocol};
  const char* end = id.data() + id.size();
  const auto first = std::from_chars(id.data(), end, address.vendor, 16);
  const bool colon = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
  const auto second = colon ? std::from_chars(first.ptr + 1, end, address.product, 16) : first;
  if (!colon || second.ec != std::errc() || second.ptr != end)
    return Error{ErrorCode::kUsage,
                 "usb:" + id + ": must be usb:VVVV:PPPP in hexadecimal, such as usb:1209:0001"};
  MIXRIG_ASSIGN(auto pipe, make_libusb_bulk(address, "usb:" + id));
  return open_tof(std::move(pipe), "usb:" + id, clock);
}

}  // namespace mixrig::device
