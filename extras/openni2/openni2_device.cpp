// SPDX-License-Identifier: Apache-2.0
#include "extras/openni2/openni2_device.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "hal/base/log.h"

namespace mixrig::device {
namespace {

constexpr int kNiBuffers = 8;

/// .oni files begin with the letters NI10.
Result<void> check_recording(const std::string& uri, const std::string& path) {
  std::array<char, 4> begin{};
  std::ifstream file(path, std::ios::binary);
  if (file.read(begin.data(), begin.size()) && std::memcmp(begin.data(), "NI10", 4) == 0) return {};
  return Error{ErrorCode::kData, uri + ": is no recording of OpenNI2: give an .oni file"};
}

}  // namespace

OpenNi2Device::~OpenNi2Device() {
  for (NiChannel& channel : channels_) stop(channel);
  if (callbacks_ != nullptr) oniUnregisterDeviceCallbacks(callbacks_);
  disconnect();
}

Result<void> OpenNi2Device::open() {
  if (!library_.works()) return openni2_error(uri_, "starting OpenNI2");
  std::error_code none;
  recording_ = std::filesystem::is_regular_file(rest_, none);
  if (recording_) MIXRIG_TRY(check_recording(uri_, rest_));
  OniDeviceCallbacks callbacks{};
  callbacks.deviceDisconnected = [](const OniDeviceInfo* device, void* self) {
    auto* me = static_cast<OpenNi2Device*>(self);
    if (std::strcmp(device->uri, me->known_.uri) == 0) me->gone_ = true;
  };
  callbacks.deviceStateChanged = [](const OniDeviceInfo* device, OniDeviceState state, void* self) {
    auto* me = static_cast<OpenNi2Device*>(self);
    if (std::strcmp(device->uri, me->known_.uri) != 0) return;
    if (state == ONI_DEVICE_STATE_EOF) me->ended_ = true;
    if (state == ONI_DEVICE_STATE_ERROR) me->gone_ = true;
  };
  MIXRIG_TRY(connect());
  if (oniRegisterDeviceCallbacks(&callbacks, this, &callbacks_) != ONI_STATUS_OK)
    return openni2_error(uri_, "asking for the device's events");
  return {};
}

/// Current URI of the device; a camera that was plugged in again may have another one.
std::optional<std::string> OpenNi2Device::address() const {
  if (recording_) return std::filesystem::absolute(rest_).string();
  const auto cameras = NiLibrary::cameras();
  const std::string wanted = known_.usbVendorId != 0 ? known_.uri : rest_;
  for (const OniDeviceInfo& camera : cameras)
    if (wanted == camera.uri) return wanted;
  for (const OniDeviceInfo& camera : cameras) {
    const bool same = camera.usbVendorId == known_.usbVendorId &&
                      camera.usbProductId == known_.usbProductId &&
                      std::strcmp(camera.name, known_.name) == 0;
    if (known_.usbVendorId != 0 ? same : rest_ == "any") return camera.uri;
  }
  if (known_.usbVendorId == 0 && rest_ != "any") return rest_;  // the library may know more
  return std::nullopt;
}

Result<void> OpenNi2Device::connect() {
  const auto at = address();
  if (!at || oniDeviceOpen(at->c_str(), &device_) != ONI_STATUS_OK) {
    device_ = nullptr;
    std::string found;
    for (const OniDeviceInfo& camera : NiLibrary::cameras())
      found += (found.empty() ? "" : ", ") + std::string("openni2:") + camera.uri;
    return Error{ErrorCode::kNotFound, uri_ + ": no such camera or file: OpenNI2 finds " +
                                           (found.empty() ? "no camera" : found)};
  }
  gone_ = ended_ = false;
  if (oniDeviceGetInfo(device_, &known_) != ONI_STATUS_OK)
    return openni2_error(uri_, "reading what it is");
  const OniImageRegistrationMode raw = ONI_IMAGE_REGISTRATION_OFF;
  if (oniDeviceIsPropertySupported(device_, ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION))
    (void)oniDeviceSetProperty(device_, ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION, &raw, sizeof raw);
  const OniBool once = FALSE;
  if (recording_)
    (void)oniDeviceSetProperty(device_, ONI_DEVICE_PROPERTY_PLAYBACK_REPEAT_ENABLED, &once,
                               sizeof once);
  for (NiChannel& channel : channels_)
    if (channel.taken) MIXRIG_TRY(make_stream(channel));
  return {};
}

void OpenNi2Device::disconnect() {
  for (NiChannel& channel : channels_)
    if (OniStreamHandle stream = std::exchange(channel.stream, nullptr)) {
      oniStreamStop(stream);
      oniStreamDestroy(stream);
    }
  if (OniDeviceHandle device = std::exchange(device_, nullptr)) (void)oniDeviceClose(device);
}

Result<void> OpenNi2Device::make_stream(NiChannel& channel) {
  const std::string uri = uri_ + " (" + channel.name + ")";
  if (oniDeviceGetSensorInfo(device_, channel.sensor) == nullptr)
    return Error{ErrorCode::kUnsupported, uri + ": the device has no such stream"};
  if (oniDeviceCreateStream(device_, channel.sensor, &channel.stream) != ONI_STATUS_OK) {
    channel.stream = nullptr;
    return openni2_error(uri, "making the stream");
  }
  MIXRIG_ASSIGN(channel.mode, set_up_openni2(channel.stream, channel.request, uri));
  const bool wrong =
      (channel.mode.format == PixelFormat::kDepth16) != (channel.sensor == ONI_SENSOR_DEPTH);
  const Size size{channel.mode.mode.resolutionX, channel.mode.mode.resolutionY};
  if (wrong ||
      (channel.pool && (size != channel.info.size || channel.mode.format != channel.info.format)))
    return Error{ErrorCode::kDevice, uri + ": sends another format than before"};
  if (channel.pool) return {};
  channel.info = {.uri = uri_,
                  .model = std::string(known_.vendor) + " " + known_.name,
                  .size = size,
                  .format = channel.mode.format,
                  .rate_hz = static_cast<double>(channel.mode.mode.fps),
                  .stamp_clock = StampClock::kDevice,
                  .usb_vendor = known_.usbVendorId,
                  .usb_product = known_.usbProductId};
  channel.depth = openni2_depth_info(channel.stream, channel.mode.mode);
  channel.pool.emplace(kNiBuffers, image_bytes(channel.info.format, size,
                                               row_bytes(channel.info.format, size.width)));
  return {};
}

Result<NiChannel*> OpenNi2Device::take(OniSensorType sensor, const StreamRequest& request) {
  const std::lock_guard lock(mutex_);
  NiChannel& channel = channels_[sensor == ONI_SENSOR_COLOR ? 0 : 1];
  if (channel.taken)
    return Error{ErrorCode::kUsage, uri_ + ": its " + channel.name + " stream is used twice"};
  if (!stop_) return Error{ErrorCode::kUsage, uri_ + ": runs already: open both cameras first"};
  channel.request = request;
  MIXRIG_TRY(make_stream(channel));
  channel.taken = true;
  return &channel;
}

}  // namespace mixrig::device
