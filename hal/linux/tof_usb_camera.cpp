// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/tof_usb_camera.h"

#include <array>
#include <atomic>
#include <charconv>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <libusb.h>

#include "hal/base/log.h"
#include "hal/linux/tof_usb_decoder.h"

namespace mixrig::device {
namespace {

constexpr int kTransfers = 8;
constexpr int kTransferBytes = 65536;
constexpr int kBuffers = 6;
constexpr unsigned kControlTimeout_ms = 1000;
constexpr Duration kLookAgain = std::chrono::milliseconds(250);
constexpr Duration kSilence = std::chrono::seconds(1);
constexpr int kVendorRequest = int{LIBUSB_REQUEST_TYPE_VENDOR} | int{LIBUSB_RECIPIENT_INTERFACE};
constexpr std::uint8_t kFromDevice = LIBUSB_ENDPOINT_IN | kVendorRequest,
                       kToDevice = kVendorRequest;
constexpr std::uint8_t kSubclass = 0x54, kProtocol = 0x01, kDescribe = 0x10, kStream = 0x11;

class TofUsbCamera final : public DepthCamera {
 public:
  TofUsbCamera(std::uint16_t vendor, std::uint16_t product, std::string id, Clock& clock)
      : vendor_(vendor), product_(product), clock_(clock) {
    info_.uri = "usb:" + std::move(id);
  }
  ~TofUsbCamera() override;
  Result<void> open();

  const CameraInfo& info() const override { return info_; }
  const DepthInfo& depth() const override { return description_.depth; }
  Result<void> start(FrameSink sink) override;
  void stop() override;
  StreamHealth health() const override;
  DepthHealth depth_health() const override;

 private:
  enum class Trouble { kNone, kStall, kGone };
  static void LIBUSB_CALL on_transfer(libusb_transfer* transfer);
  Result<void> connect();
  Result<void> find_pipe();
  Result<TofDescription> describe();
  Result<void> stream(bool on);
  Result<void> submit_all();
  void cancel_all();
  void disconnect();
  void work();
  void recover();
  void publish_health(DeviceState state);
  Error failed(const std::string& what, int code) const;

  std::uint16_t vendor_, product_;
  Clock& clock_;
  CameraInfo info_;
  TofDescription description_;
  libusb_context* context_ = nullptr;
  libusb_device_handle* handle_ = nullptr;
  int interface_ = -1;
  std::uint8_t pipe_ = 0;
  std::array<libusb_transfer*, kTransfers> transfers_{};
  std::vector<std::uint8_t> memory_;
  int in_flight_ = 0;
  Trouble trouble_ = Trouble::kNone;
  bool cancelling_ = false;
  HostTime heard_{};
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

TofUsbCamera::~TofUsbCamera() {
  stop();
  disconnect();
  for (libusb_transfer* transfer : transfers_) libusb_free_transfer(transfer);
  if (context_ != nullptr) libusb_exit(context_);
}

Error TofUsbCamera::failed(const std::string& what, int code) const {
  const bool missing = code == LIBUSB_ERROR_NO_DEVICE || code == LIBUSB_ERROR_NOT_FOUND;
  return Error{missing ? ErrorCode::kNotFound : ErrorCode::kDevice,
               info_.uri + ": " + what + " failed: " + libusb_strerror(code)};
}

Result<void> TofUsbCamera::open() {
  if (const int code = libusb_init(&context_); code != 0) return failed("starting libusb", code);
  MIXRIG_TRY(connect());
  MIXRIG_ASSIGN(description_, describe());
  info_.model = "USB ToF";
  info_.size = description_.size;
  info_.format = PixelFormat::kDepth16;
  info_.rate_hz = description_.rate_hz;
  info_.stamp_clock = StampClock::kDevice;
  const std::size_t bytes = description_.size.area() * 2;
  pool_.emplace(kBuffers, bytes, description_.amplitude ? bytes : 0);
  decoder_.emplace(description_, *pool_);
  memory_.resize(static_cast<std::size_t>(kTransfers) * kTransferBytes);
  for (auto& transfer : transfers_) {
    transfer = libusb_alloc_transfer(0);
    if (transfer == nullptr) return failed("allocating transfers", LIBUSB_ERROR_NO_MEM);
  }
  return {};
}

Result<void> TofUsbCamera::connect() {
  handle_ = libusb_open_device_with_vid_pid(context_, vendor_, product_);
  if (handle_ == nullptr)
    return Error{
        ErrorCode::kNotFound,
        info_.uri + ": no such device, or no right to open it: check cable and udev rules"};
  auto found = find_pipe();
  if (!found) {
    disconnect();
    return found;
  }
  return {};
}

Result<void> TofUsbCamera::find_pipe() {
  libusb_config_descriptor* config = nullptr;
  int code = libusb_get_active_config_descriptor(libusb_get_device(handle_), &config);
  if (code != 0) return failed("reading the configuration", code);
  interface_ = -1;
  for (int i = 0; i < config->bNumInterfaces; ++i) {
    if (config->interface[i].num_altsetting < 1) continue;
    const auto& setting = config->interface[i].altsetting[0];
    if (setting.bInterfaceClass != LIBUSB_CLASS_VENDOR_SPEC ||
        setting.bInterfaceSubClass != kSubclass || setting.bInterfaceProtocol != kProtocol)
      continue;
    for (int e = 0; e < setting.bNumEndpoints; ++e) {
      const auto& endpoint = setting.endpoint[e];
      const bool bulk =
          (endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK;
      if (!bulk || (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) == 0) continue;
      interface_ = setting.bInterfaceNumber;
      pipe_ = endpoint.bEndpointAddress;
    }
  }
  libusb_free_config_descriptor(config);
  if (interface_ < 0) return Error{ErrorCode::kDevice, info_.uri + ": has no ToF stream interface"};
  code = libusb_claim_interface(handle_, interface_);
  if (code != 0) return failed("claiming the interface", code);
  return {};
}

Result<TofDescription> TofUsbCamera::describe() {
  std::array<std::uint8_t, kTofDescriptionBytes> bytes{};
  const int got = libusb_control_transfer(handle_, kFromDevice, kDescribe, 0,
                                          static_cast<std::uint16_t>(interface_), bytes.data(),
                                          bytes.size(), kControlTimeout_ms);
  if (got < 0) return failed("asking for the description", got);
  return parse_tof_description(
      std::span<const std::uint8_t>(bytes).first(static_cast<std::size_t>(got)));
}

Result<void> TofUsbCamera::stream(bool on) {
  const int code = libusb_control_transfer(handle_, kToDevice, kStream, on ? 1 : 0,
                                           static_cast<std::uint16_t>(interface_), nullptr, 0,
                                           kControlTimeout_ms);
  if (code < 0) return failed(on ? "starting the stream" : "stopping the stream", code);
  return {};
}

Result<void> TofUsbCamera::start(FrameSink sink) {
  if (thread_.joinable()) return Error{ErrorCode::kUsage, info_.uri + ": the camera runs already"};
  if (handle_ == nullptr) MIXRIG_TRY(connect());
  sink_ = std::move(sink);
  decoder_->restart();
  MIXRIG_TRY(submit_all());
  if (auto started = stream(true); !started) {
    cancel_all();
    return started;
  }
  publish_health(DeviceState::kStreaming);
  stop_ = false;
  thread_ = std::thread([this] { work(); });
  return {};
}

void TofUsbCamera::stop() {
  stop_ = true;
  if (!thread_.joinable()) return;
  thread_.join();
  publish_health(DeviceState::kStopped);
}

Result<void> TofUsbCamera::submit_all() {
  trouble_ = Trouble::kNone;
  cancelling_ = false;
  heard_ = clock_.now();
  for (int i = 0; i < kTransfers; ++i) {
    libusb_transfer* transfer = transfers_[static_cast<std::size_t>(i)];
    libusb_fill_bulk_transfer(transfer, handle_, pipe_,
                              memory_.data() + static_cast<std::ptrdiff_t>(i) * kTransferBytes,
                              kTransferBytes, on_transfer, this, 0);
    if (const int code = libusb_submit_transfer(transfer); code != 0) {
      cancel_all();
      return failed("submitting a transfer", code);
    }
    ++in_flight_;
  }
  return {};
}

/// Waits until libusb has given every transfer back: their memory is ours.
void TofUsbCamera::cancel_all() {
  cancelling_ = true;
  for (libusb_transfer* transfer : transfers_) (void)libusb_cancel_transfer(transfer);
  timeval wait{0, 100000};
  for (int i = 0; in_flight_ > 0 && i < 50; ++i)
    (void)libusb_handle_events_timeout(context_, &wait);
}

/// Runs inside libusb_handle_events, on the driver's thread.
void LIBUSB_CALL TofUsbCamera::on_transfer(libusb_transfer* transfer) {
  auto& self = *static_cast<TofUsbCamera*>(transfer->user_data);
  --self.in_flight_;
  if (self.cancelling_) return;
  switch (transfer->status) {
    case LIBUSB_TRANSFER_COMPLETED:
    case LIBUSB_TRANSFER_TIMED_OUT:
      break;
    case LIBUSB_TRANSFER_STALL:
    case LIBUSB_TRANSFER_OVERFLOW:
    case LIBUSB_TRANSFER_ERROR:
      if (self.trouble_ == Trouble::kNone) self.trouble_ = Trouble::kStall;
      return;
    default:
      self.trouble_ = Trouble::kGone;
      return;
  }
  self.heard_ = self.clock_.now();
  self.decoder_->feed({transfer->buffer, static_cast<std::size_t>(transfer->actual_length)},
                      self.heard_, self.sink_);
  if (libusb_submit_transfer(transfer) == 0)
    ++self.in_flight_;
  else
    self.trouble_ = Trouble::kGone;
}

void TofUsbCamera::work() {
  timeval wait{0, 100000};
  while (!stop_) {
    (void)libusb_handle_events_timeout(context_, &wait);
    if (trouble_ == Trouble::kNone && clock_.now() - heard_ > kSilence) trouble_ = Trouble::kStall;
    if (trouble_ != Trouble::kNone)
      recover();
    else
      publish_health(DeviceState::kStreaming);
  }
  cancel_all();
  if (handle_ != nullptr) (void)stream(false);
}

void TofUsbCamera::recover() {
  const bool gone = trouble_ == Trouble::kGone;
  cancel_all();
  publish_health(DeviceState::kLost);
  if (gone) {
    log_warning("usb", info_.uri + ": lost; looking for it");
    disconnect();
  } else {
    ++stalls_;
  }
  while (!stop_) {
    if (handle_ == nullptr && !connect()) {
      clock_.sleep_until(clock_.now() + kLookAgain);
      continue;
    }
    (void)libusb_clear_halt(handle_, pipe_);
    decoder_->restart();
    if (submit_all() && stream(true)) break;
    cancel_all();
    disconnect();
  }
  ++returns_;
  publish_health(DeviceState::kStreaming);
}

void TofUsbCamera::disconnect() {
  if (handle_ == nullptr) return;
  if (interface_ >= 0) (void)libusb_release_interface(handle_, interface_);
  libusb_close(std::exchange(handle_, nullptr));
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

Result<std::unique_ptr<DepthCamera>> open_tof_usb(const std::string& id, Clock& clock) {
  std::uint16_t vendor = 0, product = 0;
  const char* end = id.data() + id.size();
  const auto first = std::from_chars(id.data(), end, vendor, 16);
  const bool colon = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
  const auto second = colon ? std::from_chars(first.ptr + 1, end, product, 16) : first;
  if (!colon || second.ec != std::errc() || second.ptr != end)
    return Error{ErrorCode::kUsage,
                 "usb:" + id + ": must be usb:VVVV:PPPP in hexadecimal, such as usb:1209:0001"};
  auto camera = std::make_unique<TofUsbCamera>(vendor, product, id, clock);
  MIXRIG_TRY(camera->open());
  return std::unique_ptr<DepthCamera>(std::move(camera));
}

}  // namespace mixrig::device
