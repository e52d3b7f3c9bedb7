// SPDX-License-Identifier: Apache-2.0
// What the cameras of a running rig are set to, and its changes while they deliver.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/base/result.h"
#include "hal/device/camera.h"

namespace mixrig::live {

struct CameraSetting {
  device::ControlRange range;
  std::optional<double> value;  ///< as last read; absent where the device does not tell it
};
struct CameraSetup {
  std::string name;  ///< as in rig.toml
  std::vector<CameraSetting> settings;
};

/// A thread of its own sets and reads the cameras between follow() and end(): it is the one thread
/// of device::Camera::set() and get() then, and frames never wait for it. The other methods are for
/// any thread.
class CameraSettings {
 public:
  CameraSettings() = default;
  ~CameraSettings() { end(); }
  CameraSettings(const CameraSettings&) = delete;
  CameraSettings& operator=(const CameraSettings&) = delete;

  struct Named {
    std::string name;
    device::Camera* camera = nullptr;
  };
  /// The cameras stay until end().
  void follow(std::vector<Named> cameras);
  /// Returns when the thread has left the cameras.
  void end();

  /// Empty before follow() and after end(). Values are read every two seconds, since a camera may
  /// adjust itself.
  std::vector<CameraSetup> cameras() const;
  /// Returns when the camera has answered. Errors: kNotFound where no such camera runs, kUsage out
  /// of its range, kUnsupported, kDevice; kData while another setting waits for its camera.
  Result<void> set(const std::string& camera, device::CameraControl control, double value);

 private:
  struct Wish {
    std::size_t camera = 0;
    device::CameraControl control = device::CameraControl::kExposure;
    double value = 0;
  };
  void run();
  void read();
  Result<std::size_t> check(const std::string& camera, device::CameraControl control,
                            double value) const;

  std::vector<Named> cameras_;  ///< of the thread, while it runs
  std::thread thread_;
  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable wake_, answered_;
  bool ends_ = true;
  std::vector<CameraSetup> setups_;
  std::optional<Wish> wish_;
  bool waits_ = false;  ///< a set() waits for its answer
  std::optional<Result<void>> answer_;
};

}  // namespace mixrig::live
