// SPDX-License-Identifier: Apache-2.0
#include "hal/device/camera.h"

namespace mixrig::device {

std::string_view name(CameraControl control) {
  switch (control) {
    case CameraControl::kExposure:
      return "exposure";
    case CameraControl::kGain:
      return "gain";
    case CameraControl::kFocus:
      return "focus";
    case CameraControl::kWhiteBalance:
      return "white_balance";
    case CameraControl::kZoom:
      return "zoom";
  }
  return "unknown";
}

std::string_view name(DeviceState state) {
  switch (state) {
    case DeviceState::kStopped:
      return "stopped";
    case DeviceState::kStreaming:
      return "streaming";
    case DeviceState::kLost:
      return "lost";
    case DeviceState::kFailed:
      return "failed";
  }
  return "unknown";
}

}  // namespace mixrig::device
