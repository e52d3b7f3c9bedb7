// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/held_controls.h"

#include <algorithm>

#include "hal/base/log.h"
#include "host/math/config/table.h"
#include "host/math/config/writer.h"

namespace mixrig::live {
namespace {

/// Controls that may adjust themselves; zoom never does.
constexpr std::array<device::CameraControl, 4> kControls{
    device::CameraControl::kExposure, device::CameraControl::kGain, device::CameraControl::kFocus,
    device::CameraControl::kWhiteBalance};

bool is_fixed(const CameraConfig& config, device::CameraControl control) {
  switch (control) {
    case device::CameraControl::kExposure:
      return config.exposure_s.has_value();
    case device::CameraControl::kGain:
      return config.gain.has_value();
    case device::CameraControl::kFocus:
      return config.focus.has_value();
    case device::CameraControl::kWhiteBalance:
      return config.white_balance_k.has_value();
    case device::CameraControl::kZoom:
      break;
  }
  return true;
}

bool is_offered(const device::CameraInfo& info, device::CameraControl control) {
  return std::any_of(info.controls.begin(), info.controls.end(),
                     [&](const device::ControlRange& range) { return range.control == control; });
}

Result<double> hold(device::Camera& camera, device::CameraControl control,
                    std::optional<double> value) {
  if (!value) {
    MIXRIG_ASSIGN(value, camera.get(control));
  }
  MIXRIG_TRY(camera.set(control, *value));
  return *value;
}

}  // namespace

bool adjusts_itself(const CameraConfig& config, const device::CameraInfo& info) {
  return std::any_of(kControls.begin(), kControls.end(), [&](device::CameraControl control) {
    return is_offered(info, control) && !is_fixed(config, control);
  });
}

HeldControls hold_controls(const CameraConfig& config, device::Camera& camera,
                           const HeldControls& earlier) {
  HeldControls held;
  for (std::size_t i = 0; i < kControls.size(); ++i) {
    const device::CameraControl control = kControls[i];
    if (!is_offered(camera.info(), control) || is_fixed(config, control)) continue;
    if (const auto value = hold(camera, control, earlier[i]))
      held[i] = *value;
    else
      log_warning("rig", to_line(value.error()) + ": it may change from view to view");
  }
  return held;
}

std::string held_text(const HeldControls& held) {
  config::Writer root;
  root.set("format", 1);
  for (std::size_t i = 0; i < kControls.size(); ++i)
    if (held[i]) root.set(device::name(kControls[i]), *held[i]);
  return root.text();
}

Result<HeldControls> parse_held(std::string_view text, const std::string& name) {
  MIXRIG_ASSIGN(config::Document document, config::Document::parse(text, name));
  const config::Table root = document.root();
  HeldControls held;
  (void)root.integer("format", {1, 1});
  for (std::size_t i = 0; i < kControls.size(); ++i)
    if (const auto key = device::name(kControls[i]); root.has(key)) held[i] = root.number(key);
  MIXRIG_TRY(document.finish());
  return held;
}

}  // namespace mixrig::live
