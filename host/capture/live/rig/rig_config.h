// SPDX-License-Identifier: Apache-2.0
// rig.toml: the devices of a rig, their triggers and the calibration of the cameras.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.h"
#include "hal/device/camera.h"
#include "hal/device/depth_camera.h"
#include "hal/device/trigger.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/depth_noise.h"
#include "host/math/geometry/pose.h"

namespace mixrig::live {

/// Meaning of the samples of a colour camera; absent values are those that the device reports.
struct ColorConfig {
  std::optional<device::Transfer> transfer;
  double gamma = 2.2;  ///< used by Transfer::kGamma only
  std::optional<device::YuvMatrix> matrix;
  std::optional<device::SampleRange> range;
  double black_level = 0;  ///< sample without light, in the camera's own steps
  /// Factors of red, green and blue light, each 1 or more.
  std::array<double, 3> white_gains{1, 1, 1};
};

/// Meaning of depth steps; absent values are those that the device reports.
struct DepthConfig {
  std::optional<double> unit_m, offset_m;
  std::optional<device::DepthMeaning> kind;
  std::vector<int> unknown;  ///< empty: absent
  std::optional<geometry::DepthNoise> noise;
  std::optional<int> least_confidence;
  std::optional<bool> light;
  device::DepthInfo applied_to(device::DepthInfo told) const;
};

struct CameraConfig {
  std::string name, uri;
  device::StreamRequest request;
  int trigger_line = -1;  ///< line of the trigger that fires the camera; -1 runs free
  Duration delay{};  ///< from the tick to the stamp: trigger latency, half the exposure, transport
  std::optional<double> exposure_s, gain, focus, white_balance_k, zoom;
  ColorConfig color;  ///< only for a [[camera]]
};

struct TriggerLine {
  int line = 0;
  device::TriggerChannel channel;
};

/// Name of the camera whose pictures become Capture::fisheye.
inline constexpr const char* kFisheye = "fisheye";

struct RigConfig {
  std::string name;
  std::filesystem::path file;  ///< the file that was read
  std::filesystem::path
      calibration;          ///< calibration.toml that replaces the cameras below, or empty
  std::string trigger_uri;  ///< empty: cameras run free, or another program starts the trigger
  std::string edges_uri;    ///< GPIO line of this host wired to `edges_line`, or empty
  int edges_line = -1;
  std::vector<TriggerLine> lines;
  std::vector<CameraConfig> cameras;  ///< the first one is the target camera
  std::optional<CameraConfig> depth;
  DepthConfig depth_steps;
  std::optional<CameraConfig> depth2;  ///< a second depth camera, only with `depth`
  DepthConfig depth2_steps;
  std::string pan_tilt_uri;
  std::string lens_uri;             ///< encoders of the target camera's lens, or empty
  Duration lens_delay{};            ///< from the time of a packet's values to its arrival
  std::optional<HostTime> play_at;  ///< time of the first frame of played recordings
  std::optional<geometry::CameraModel> target, tof;  ///< inline calibration, if given
  std::optional<geometry::Pose> target_from_tof;
  std::optional<geometry::CameraModel> tof2;  ///< camera of `depth2`
  std::optional<geometry::Pose> target_from_tof2;
  std::optional<geometry::Pose> world_from_target;  ///< pose of a rig that does not move

  const TriggerLine* line_of(const CameraConfig& camera) const { return line(camera.trigger_line); }
  /// Returns the line; null if the trigger has no such line.
  const TriggerLine* line(int number) const;
};

/// Returns the word of rig.toml for a transfer.
std::string_view transfer_word(device::Transfer transfer);

/// Reads rig.toml. Errors: kNotFound, kFormat (file:line: key ...).
Result<RigConfig> read_rig(const std::filesystem::path& path);
/// Parses the text of a rig.toml; `name` stands for the file. Pure. Errors: kFormat.
Result<RigConfig> parse_rig(std::string_view text, const std::string& name);
/// Returns the rig as rig.toml, from which parse_rig() reads back the same rig, without calibration
/// and world_from_target.
std::string rig_text(const RigConfig& rig);

}  // namespace mixrig::live
