// SPDX-License-Identifier: Apache-2.0
// Depth cameras: 16-bit steps and what a step means.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "hal/device/camera.h"

namespace mixrig::device {

enum class DepthMeaning { kZ, kDistance };  ///< along the optical axis, or along the ray

/// Pinhole camera that the device reports, in pixels, with the device's own pixel convention.
struct DeviceIntrinsics {
  double focal_px = 0, principal_x_px = 0, principal_y_px = 0;
};

/// Converts depth steps: metres = step * metres_per_step + offset_m, along the axis or ray
/// (`meaning`). Steps in unknown_steps and pixels below least_confidence are no measurement.
struct DepthInfo {
  double metres_per_step = 0.001;
  bool unit_known = true;  ///< false: the device does not report the size of a step
  double offset_m = 0;     ///< distance of step 0 from the centre of projection
  /// Steps that mean "no measurement"; drivers write the first.
  std::vector<int> unknown_steps = {0};
  /// Pixels below this are no measurement. It is compared with Frame::confidence where a frame has
  /// it, else with its amplitude. 0: all pixels are used.
  int least_confidence = 0;
  /// Amplitude is proportional to the returned light, which falls with the square of the distance.
  bool amplitude_is_light = false;
  DepthMeaning meaning = DepthMeaning::kZ;
  std::optional<DeviceIntrinsics> intrinsics{};
};

/// State of the sensor; NaN where the device does not report it.
struct DepthHealth {
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  double mean_amplitude =
      std::numeric_limits<double>::quiet_NaN();  ///< of the last frame, 0..65535
};

/// A ToF or stereo camera. Frames are kDepth16, with amplitude where the device has it.
/// Threads: see Camera.
class DepthCamera {
 public:
  virtual ~DepthCamera() = default;
  virtual const CameraInfo& info() const = 0;
  virtual const DepthInfo& depth() const = 0;
  virtual Result<void> start(FrameSink sink) = 0;
  virtual void stop() = 0;
  virtual StreamHealth health() const = 0;
  virtual DepthHealth depth_health() const = 0;
};

/// Converts a kDepth16 frame to metres; 0 = unknown. Reuses the memory of `out`.
/// Errors: kData where the frame is of another format or shorter than its size says.
Result<void> to_metres(const Frame& frame, const DepthInfo& info, Image<float>& out);

/// Wraps a camera that delivers 16-bit steps as a depth camera.
std::unique_ptr<DepthCamera> as_depth_camera(std::unique_ptr<Camera> camera, const DepthInfo& info);

}  // namespace mixrig::device
