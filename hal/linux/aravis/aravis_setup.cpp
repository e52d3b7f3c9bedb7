// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/aravis/aravis_setup.h"

#include <cmath>
#include <optional>

#include <arv.h>

#include "hal/wire/genicam_buffer.h"

namespace mixrig::device {
namespace {

std::optional<double> feature(ArvDevice* device, const char* name) {
  AravisFault fault;
  if (!arv_device_is_feature_available(device, name, fault) || fault.any()) return std::nullopt;
  const double value = arv_device_get_float_feature_value(device, name, fault);
  if (!fault.any()) return value;
  const gint64 integer = arv_device_get_integer_feature_value(device, name, fault);
  if (fault.any()) return std::nullopt;
  return static_cast<double>(integer);
}

}  // namespace

std::string AravisFault::text() const {
  return error_ != nullptr ? error_->message : "no reason given";
}
void AravisFault::clear() { g_clear_error(&error_); }

Result<std::uint32_t> choose_aravis_format(ArvCamera* camera, const StreamRequest& request,
                                           CameraInfo& info) {
  AravisFault fault;
  arv_camera_stop_acquisition(camera, fault);  // may still run for a client that crashed
  if (request.format != PixelFormat::kUnknown) {
    const std::uint32_t wanted = pfnc_of_format(request.format);
    if (wanted != 0) arv_camera_set_pixel_format(camera, wanted, fault);
    if (wanted == 0 || fault.any())
      return Error{ErrorCode::kUnsupported,
                   info.uri + ": does not offer " + std::string(name(request.format))};
  }
  if (!request.size.empty()) {
    arv_camera_set_region(camera, 0, 0, request.size.width, request.size.height, fault);
    if (fault.any()) return fault.error(info.uri, "setting the picture's size");
  }
  const std::uint32_t code = arv_camera_get_pixel_format(camera, fault);
  info.format = format_of_pfnc(code);
  if (info.format == PixelFormat::kUnknown)
    return Error{ErrorCode::kUnsupported,
                 info.uri + ": sends a pixel format that mixrig does not read"};
  int x = 0, y = 0;
  arv_camera_get_region(camera, &x, &y, &info.size.width, &info.size.height, fault);
  if (fault.any() || declared_bytes(code, info.size) == 0)
    return fault.error(info.uri, "reading the picture's size");
  if (!request.size.empty() && info.size != request.size)
    return Error{ErrorCode::kUnsupported, info.uri + ": does not offer the requested size"};
  return code;
}

Result<void> choose_aravis_trigger(ArvCamera* camera, const StreamRequest& request,
                                   CameraInfo& info) {
  AravisFault fault;
  info.hardware_trigger = request.hardware_trigger;
  if (request.hardware_trigger) {
    arv_camera_set_trigger(camera, "Line0", fault);
    if (fault.any()) return fault.error(info.uri, "setting the trigger to Line0");
    return {};
  }
  arv_camera_clear_triggers(camera, fault);
  if (request.rate_hz > 0) {
    arv_camera_set_frame_rate(camera, request.rate_hz, fault);
    if (fault.any()) return fault.error(info.uri, "setting the frame rate");
  }
  info.rate_hz = arv_camera_get_frame_rate(camera, fault);
  return {};
}

void describe_aravis(ArvCamera* camera, CameraInfo& info) {
  AravisFault fault;
  const char* model = arv_camera_get_model_name(camera, fault);
  info.model = model != nullptr ? model : "";
  const char* serial = arv_camera_get_device_serial_number(camera, fault);
  info.serial = serial != nullptr ? serial : "";
  double low = 0, high = 0;
  arv_camera_get_exposure_time_bounds(camera, &low, &high, fault);
  if (!fault.any() && high > low)
    info.controls.push_back({CameraControl::kExposure, low * 1e-6, high * 1e-6, 1e-6});
  arv_camera_get_gain_bounds(camera, &low, &high, fault);
  if (!fault.any() && high > low) info.controls.push_back({CameraControl::kGain, low, high, 0.1});
}

Result<DepthInfo> aravis_depth_info(ArvCamera* camera, const std::string& uri) {
  ArvDevice* device = arv_camera_get_device(camera);
  AravisFault fault;
  if (arv_device_is_feature_available(device, "Scan3dCoordinateSelector", fault))
    arv_device_set_string_feature_value(device, "Scan3dCoordinateSelector", "CoordinateC", fault);
  DepthInfo depth;
  const auto scale = feature(device, "Scan3dCoordinateScale");
  if (!scale || !(*scale > 0) || !std::isfinite(*scale))
    return Error{ErrorCode::kDevice,
                 uri + ": does not report Scan3dCoordinateScale: its depth has no unit"};
  depth.metres_per_step = *scale * 1e-3;
  depth.offset_m = feature(device, "Scan3dCoordinateOffset").value_or(0) * 1e-3;
  depth.unknown_step = static_cast<int>(feature(device, "Scan3dInvalidDataValue").value_or(0));
  const auto focal = feature(device, "Scan3dFocalLength");
  const auto u = feature(device, "Scan3dPrincipalPointU"),
             v = feature(device, "Scan3dPrincipalPointV");
  if (focal && u && v && *focal > 0) depth.intrinsics = DeviceIntrinsics{*focal, *u, *v};
  return depth;
}

}  // namespace mixrig::device
