// SPDX-License-Identifier: Apache-2.0
// Fixes controls of a camera that would adjust themselves between the views of a sweep.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "hal/device/camera.h"
#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {

/// Values by CameraControl, in the device's units (exposure in seconds).
using HeldControls = std::array<std::optional<double>, device::kCameraControls>;

/// Whether the camera offers a control that rig.toml does not fix.
bool adjusts_itself(const CameraConfig& config, const device::CameraInfo& info);

/// Fixes each such control, which ends its automatic mode: at the value of `earlier` where it has
/// one, else at the present one. A value that cannot be read or set is left out with a warning.
HeldControls hold_controls(const CameraConfig& config, device::Camera& camera,
                           const HeldControls& earlier);

/// Write and read held controls as TOML; pure. Errors of reading: kFormat.
std::string held_text(const HeldControls& held);
Result<HeldControls> parse_held(std::string_view text, const std::string& name);

}  // namespace mixrig::live
