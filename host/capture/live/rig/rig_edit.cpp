// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/rig_edit.h"

#include <algorithm>
#include <cmath>

#include "host/capture/live/rig/rig_config.h"
#include "host/math/config/toml_lines.h"
#include "host/math/config/writer.h"

namespace mixrig::live {
namespace {

constexpr int kControlDigits = 7;

std::optional<double> fixed_value(const CameraConfig& camera, device::CameraControl control) {
  switch (control) {
    case device::CameraControl::kExposure:
      return camera.exposure_s;
    case device::CameraControl::kGain:
      return camera.gain;
    case device::CameraControl::kFocus:
      return camera.focus;
    case device::CameraControl::kWhiteBalance:
      return camera.white_balance_k;
    case device::CameraControl::kZoom:
      return camera.zoom;
  }
  return std::nullopt;
}

}  // namespace

ControlKey control_key(device::CameraControl control) {
  switch (control) {
    case device::CameraControl::kExposure:
      return {"exposure_ms", 1e3};
    case device::CameraControl::kWhiteBalance:
      return {"white_balance_k"};
    case device::CameraControl::kGain:
    case device::CameraControl::kFocus:
    case device::CameraControl::kZoom:
      break;
  }
  return {device::name(control)};
}

Result<std::string> with_control(std::string_view text, const std::string& name,
                                 const std::string& camera, device::CameraControl control,
                                 double value) {
  MIXRIG_ASSIGN(const RigConfig rig, parse_rig(text, name));
  const auto found = std::find_if(rig.cameras.begin(), rig.cameras.end(),
                                  [&](const CameraConfig& one) { return one.name == camera; });
  if (found == rig.cameras.end())
    return Error{ErrorCode::kNotFound, name + ": has no [[camera]] \"" + camera + "\""};
  const auto index = static_cast<std::size_t>(found - rig.cameras.begin());
  config::Lines lines = config::lines_of(text);
  const auto blocks = config::blocks_of(lines, "[[camera]]");
  const ControlKey key = control_key(control);
  if (blocks.size() == rig.cameras.size())
    config::set_number(lines, blocks[index], key.key,
                       config::rounded(value * key.unit, kControlDigits));
  std::string edited = config::text_of_lines(lines);
  const auto check = parse_rig(edited, name);
  const auto now = check && check->cameras.size() == rig.cameras.size()
                       ? fixed_value(check->cameras[index], control)
                       : std::nullopt;
  if (now && std::abs(*now - value) <= 1e-5 * std::abs(value)) return edited;
  return Error{ErrorCode::kFormat,
               name + ": " + std::string(key.key) +
                   " cannot be written: write each camera as a table [[camera]], with each key on "
                   "one line, and a value within the key's range"};
}

}  // namespace mixrig::live
