// SPDX-License-Identifier: Apache-2.0
// Edits a rig.toml and leaves the rest of its text unchanged. Pure.
#pragma once

#include <string>
#include <string_view>

#include "hal/base/result.h"
#include "hal/device/camera.h"

namespace mixrig::live {

/// The key of rig.toml that fixes a control, and its unit: value in the file = unit * value of
/// device::Camera::set().
struct ControlKey {
  std::string_view key;
  double unit = 1;
};
ControlKey control_key(device::CameraControl control);

/// Returns the text with a control of the [[camera]] `camera` fixed at `value` (in the unit of
/// device::Camera::set()). `name` names the file in errors. Errors: kFormat if the text is no rig
/// or its cameras are not [[camera]] tables; kNotFound if there is no such camera.
Result<std::string> with_control(std::string_view text, const std::string& name,
                                 const std::string& camera, device::CameraControl control,
                                 double value);

}  // namespace mixrig::live
