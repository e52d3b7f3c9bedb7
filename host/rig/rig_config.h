// SPDX-License-Identifier: Apache-2.0
// rig.toml: which devices a rig has, how they are triggered, how their cameras see.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.h"
#include "hal/device/camera.h"
#include "hal/device/trigger.h"
#include "host/geometry/camera_model.h"
#include "host/geometry/pose.h"

namespace mixrig::rig {

struct CameraConfig {
  std::string name, uri;
  device::StreamRequest request;
  int trigger_line = -1;  ///< line of the trigger that fires it; -1 runs free
  Duration delay{};  ///< from the tick to the stamp: trigger latency, half the exposure, transport
  std::optional<double> exposure_s, gain, focus, white_balance_k;
};

struct TriggerLine {
  int line = 0;
  device::TriggerChannel channel;
};

struct RigConfig {
  std::string name;
  std::filesystem::path calibration;  ///< calibration.yaml in place of the cameras below, or empty
  std::string trigger_uri;  ///< empty: everything runs free, or somebody else starts the trigger
  std::string edges_uri;    ///< line of this host that sees the pulses of `edges_line`; or empty
  int edges_line = -1;
  std::vector<TriggerLine> lines;
  std::vector<CameraConfig> cameras;  ///< the first one leads: it is the target camera
  std::optional<CameraConfig> depth;
  std::string pan_tilt_uri;
  std::optional<geometry::CameraModel> target, tof;  ///< calibration, where it is known
  std::optional<geometry::Pose> target_from_tof;
  std::optional<geometry::Pose> world_from_target;  ///< of a rig that stands still

  const TriggerLine* line_of(const CameraConfig& camera) const { return line(camera.trigger_line); }
  /// Null where the trigger has no such line.
  const TriggerLine* line(int number) const;
};

/// Errors: kNotFound, kFormat (file:line: key ...).
Result<RigConfig> read_rig(const std::filesystem::path& path);
/// The same from text; pure.
Result<RigConfig> parse_rig(std::string_view text, const std::string& name);
/// As rig.toml; reads back as the same rig, calibration left out.
std::string rig_text(const RigConfig& rig);

}  // namespace mixrig::rig
