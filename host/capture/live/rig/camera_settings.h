// SPDX-License-Identifier: Apache-2.0
// Reads and changes the controls of the cameras of a running rig while they deliver.
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
  std::optional<double> value;  ///< as last read; absent if the device does not report it
};
struct CameraSetup {
  std::string name;  ///< name in rig.toml
  std::vector<CameraSetting> settings;
};

/// Owns a thread that sets and reads the cameras between follow() and end(). It is then the only
/// thread that calls device::Camera::set() and get(), and frames never wait for it. Any thread may
/// call the other methods.
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
  /// Begins to read and set these cameras, which must live until end().
  void follow(std::vector<Named> cameras);
  /// Ends the thread; returns when it no longer uses the cameras.
  void end();

  /// Returns the cameras with their settings; empty before follow() and after end(). Values are
  /// read every two seconds, since a camera may adjust itself.
  std::vector<CameraSetup> cameras() const;
  /// Sets a control and returns when the camera has answered. Errors: kNotFound if no such camera
  /// runs, kUsage out of its range, kUnsupported, kDevice; kData while another setting waits for
  /// its camera; kIo after the thread has failed.
  Result<void> set(const std::string& camera, device::CameraControl control, double value);

 private:
  struct Wish {
    std::size_t camera = 0;
    device::CameraControl control = device::CameraControl::kExposure;
    double value = 0;
  };
  void run();
  void fail(const Error& error);
  void read();
  Result<std::size_t> check(const std::string& camera, device::CameraControl control,
                            double value) const;

  std::vector<Named> cameras_;  ///< used by the thread while it runs
  std::thread thread_;
  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable wake_, answered_;
  bool ends_ = true;
  std::vector<CameraSetup> setups_;
  std::optional<Wish> wish_;
  bool waits_ = false;  ///< a set() waits for its answer
  std::optional<Result<void>> answer_;
  std::optional<Error> fault_;  ///< what the thread threw
};

}  // namespace mixrig::live
