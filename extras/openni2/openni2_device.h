// SPDX-License-Identifier: Apache-2.0
// An OpenNI2 device with its streams and its thread. Private to this module.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <OniCAPI.h>

#include "extras/openni2/openni2_stream.h"
#include "hal/base/clock.h"
#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"
#include "hal/device/frame_pool.h"
#include "hal/device/stream_count.h"

namespace mixrig::device {

/// Holds one reference to the library, and lists its devices.
class NiLibrary {
 public:
  NiLibrary() : status_(oniInitialize(ONI_API_VERSION)) {}
  NiLibrary(const NiLibrary&) = delete;
  NiLibrary& operator=(const NiLibrary&) = delete;
  ~NiLibrary() { oniShutdown(); }
  bool works() const { return status_ == ONI_STATUS_OK; }
  /// USB cameras only: neither the library's dummy nor opened files.
  static std::vector<OniDeviceInfo> cameras() {
    OniDeviceInfo* listed = nullptr;
    int count = 0;
    if (oniGetDeviceList(&listed, &count) != ONI_STATUS_OK) return {};
    std::vector<OniDeviceInfo> found;
    for (int i = 0; i < count; ++i)
      if (listed[i].usbVendorId != 0) found.push_back(listed[i]);
    (void)oniReleaseDeviceList(listed);
    return found;
  }

 private:
  OniStatus status_;
};

struct NiChannel {
  OniSensorType sensor;
  const char* name;
  StreamRequest request{};
  CameraInfo info{};
  OpenNi2Mode mode{};
  DepthInfo depth{};
  OniStreamHandle stream = nullptr;
  std::optional<FramePool> pool{};
  bool taken = false;
  FrameSink sink{};  ///< empty while the camera is stopped
  StreamCount count{};
};

class OpenNi2Device : public std::enable_shared_from_this<OpenNi2Device> {
 public:
  OpenNi2Device(const std::string& uri, Clock& clock)
      : rest_(uri), uri_("openni2:" + uri), clock_(clock) {}
  ~OpenNi2Device();
  Result<void> open();
  Result<NiChannel*> take(OniSensorType sensor, const StreamRequest& request);
  Result<void> start(NiChannel& channel, FrameSink sink);
  void stop(NiChannel& channel);
  StreamHealth health(const NiChannel& channel) const;

 private:
  Result<void> connect();
  void disconnect();
  Result<void> make_stream(NiChannel& channel);
  Result<void> start_streams();
  std::optional<std::string> address() const;
  void work();
  void publish(NiChannel& channel, const OniFrame& frame);
  void come_back();
  void set_state(DeviceState state);

  const std::string rest_, uri_;  ///< URI of the library, and of the rig
  Clock& clock_;
  NiLibrary library_;
  OniCallbackHandle callbacks_ = nullptr;
  OniDeviceInfo known_{};  ///< as first opened
  OniDeviceHandle device_ = nullptr;
  bool recording_ = false;
  std::atomic<bool> gone_ = false, ended_ = false, stop_ = true;
  std::thread thread_;
  mutable std::mutex mutex_;  ///< guards the channels and device_ against other threads
  std::array<NiChannel, 2> channels_{NiChannel{ONI_SENSOR_COLOR, "color"},
                                     NiChannel{ONI_SENSOR_DEPTH, "depth"}};
};

}  // namespace mixrig::device
