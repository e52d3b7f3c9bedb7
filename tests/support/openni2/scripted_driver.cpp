// SPDX-License-Identifier: Apache-2.0
// A driver module of OpenNI2 whose camera shows the test's pictures (scripted_driver.h).
#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(object) delete object
#include "tests/support/openni2/scripted_driver.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <vector>

#include <Driver/OniDriverAPI.h>

namespace {

constexpr int kRate_hz = 30;

std::recursive_mutex mutex;
ScriptedCamera camera{64, 48, 1000, 1.0F, 64, 48, 33333};
int registration = ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
bool plugged = true;

OniPixelFormat depth_format() {
  return camera.depth_unit_um == 100 ? ONI_PIXEL_FORMAT_DEPTH_100_UM : ONI_PIXEL_FORMAT_DEPTH_1_MM;
}

template <typename T>
OniStatus give(const T& value, void* data, int* bytes) {
  if (*bytes != sizeof value) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof value);
  return ONI_STATUS_OK;
}

class ScriptedStream final : public oni::driver::StreamBase {
 public:
  explicit ScriptedStream(OniSensorType sensor) : sensor_(sensor) {
    const std::lock_guard lock(mutex);
    streams().push_back(this);
  }
  ~ScriptedStream() override {
    const std::lock_guard lock(mutex);
    std::erase(streams(), this);
  }
  static std::vector<ScriptedStream*>& streams() {
    static std::vector<ScriptedStream*> all;
    return all;
  }
  OniStatus start() override {
    const std::lock_guard lock(mutex);
    running_ = true;
    return ONI_STATUS_OK;
  }
  void stop() override {
    const std::lock_guard lock(mutex);
    running_ = false;
  }
  bool running() const { return running_; }
  OniStatus getProperty(int id, void* data, int* bytes) override {
    const float across = std::tan(camera.fov_rad / 2);
    switch (id) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return give(mode(), data, bytes);
      case ONI_STREAM_PROPERTY_MIRRORING:
        return give(mirrored_, data, bytes);
      case ONI_STREAM_PROPERTY_STRIDE:
        return give(stride(), data, bytes);
      case ONI_STREAM_PROPERTY_CROPPING:
        return give(OniCropping{}, data, bytes);
      case ONI_STREAM_PROPERTY_MAX_VALUE:
        return give(65535, data, bytes);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
        return camera.fov_rad > 0 ? give(camera.fov_rad, data, bytes) : ONI_STATUS_NOT_SUPPORTED;
      case ONI_STREAM_PROPERTY_VERTICAL_FOV: {
        const float down = 2 * std::atan(across * static_cast<float>(camera.height) /
                                         static_cast<float>(camera.width));
        return camera.fov_rad > 0 ? give(down, data, bytes) : ONI_STATUS_NOT_SUPPORTED;
      }
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }
  OniStatus setProperty(int id, const void* data, int bytes) override {
    if (id != ONI_STREAM_PROPERTY_MIRRORING || bytes != sizeof mirrored_)
      return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(&mirrored_, data, sizeof mirrored_);
    return ONI_STATUS_OK;
  }
  OniBool isPropertySupported(int id) override { return id == ONI_STREAM_PROPERTY_MIRRORING; }
  void emit(int number, const std::uint8_t* picture) {
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    const int pixel = stride() / width();
    frame->frameIndex = number;
    frame->timestamp =
        static_cast<std::uint64_t>(number) * static_cast<std::uint64_t>(camera.period_us);
    frame->videoMode = mode();
    frame->sensorType = sensor_;
    frame->width = width();
    frame->height = height();
    frame->stride = stride();
    frame->dataSize = stride() * height();
    frame->croppingEnabled = FALSE;
    auto* out = static_cast<std::uint8_t*>(frame->data);
    for (int y = 0; y < height(); ++y)
      for (int x = 0; x < width(); ++x) {
        const int from = mirrored_ != FALSE ? width() - 1 - x : x;
        std::memcpy(out + y * stride() + x * pixel, picture + y * stride() + from * pixel,
                    static_cast<std::size_t>(pixel));
      }
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }
  bool is_depth() const { return sensor_ == ONI_SENSOR_DEPTH; }

 private:
  int width() const { return is_depth() ? camera.width : camera.color_width; }
  int height() const { return is_depth() ? camera.height : camera.color_height; }
  OniVideoMode mode() const {
    return {is_depth() ? depth_format() : ONI_PIXEL_FORMAT_RGB888, width(), height(), kRate_hz};
  }
  int stride() const { return width() * (is_depth() ? 2 : 3); }

  OniSensorType sensor_;
  OniBool mirrored_ = TRUE;
  bool running_ = false;
};

class ScriptedDevice final : public oni::driver::DeviceBase {
 public:
  ScriptedDevice()
      : modes_{{ONI_PIXEL_FORMAT_RGB888, camera.color_width, camera.color_height, kRate_hz},
               {depth_format(), camera.width, camera.height, kRate_hz}},
        sensors_{{ONI_SENSOR_COLOR, 1, &modes_[0]}, {ONI_SENSOR_DEPTH, 1, &modes_[1]}} {}
  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_;
    *count = 2;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    return new ScriptedStream(sensor);
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }
  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION;
  }
  OniStatus setProperty(int id, const void* data, int bytes) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || bytes != sizeof registration)
      return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(&registration, data, sizeof registration);
    return ONI_STATUS_OK;
  }

 private:
  OniVideoMode modes_[2];
  OniSensorInfo sensors_[2];
};

class ScriptedDriver final : public oni::driver::DriverBase {
 public:
  explicit ScriptedDriver(OniDriverServices* services) : DriverBase(services) {
    std::strcpy(info_.uri, "scripted");
    std::strcpy(info_.vendor, "mixrig");
    std::strcpy(info_.name, "scripted camera");
    info_.usbVendorId = 0x1209;
    info_.usbProductId = 0x0002;
    present = this;
  }
  ~ScriptedDriver() override { present = nullptr; }
  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    if (plugged) deviceConnected(&info_);
    return ONI_STATUS_OK;
  }
  void plug(bool in) { in ? deviceConnected(&info_) : deviceDisconnected(&info_); }
  oni::driver::DeviceBase* deviceOpen(const char*, const char*) override {
    return plugged ? new ScriptedDevice : nullptr;
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override {}
  static ScriptedDriver* present;

 private:
  OniDeviceInfo info_{};
};
ScriptedDriver* ScriptedDriver::present = nullptr;

}  // namespace

extern "C" {
void scripted_describe(const ScriptedCamera* described) { camera = *described; }
void scripted_plug(int in) {
  plugged = in != 0;
  if (ScriptedDriver::present != nullptr) ScriptedDriver::present->plug(plugged);
}
void scripted_expose(int frame, const std::uint16_t* depth, const std::uint8_t* rgb) {
  const std::lock_guard lock(mutex);
  for (ScriptedStream* stream : ScriptedStream::streams())
    if (stream->running() && plugged)
      stream->emit(frame, stream->is_depth() ? reinterpret_cast<const std::uint8_t*>(depth) : rgb);
}
int scripted_streams() {
  const std::lock_guard lock(mutex);
  int count = 0;
  for (const ScriptedStream* stream : ScriptedStream::streams()) count += stream->running() ? 1 : 0;
  return count;
}
int scripted_registered() { return registration; }
}

ONI_EXPORT_DRIVER(ScriptedDriver)
