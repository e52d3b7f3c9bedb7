// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/aravis/aravis_setup.h"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <arv.h>

#include "hal/wire/camera/genicam_buffer.h"

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

namespace {

/// Sets the first of the formats that the camera accepts.
bool set_first_format(ArvCamera* camera, PixelFormat format) {
  AravisFault fault;
  for (const std::uint32_t code : pfncs_of_format(format)) {
    arv_camera_set_pixel_format(camera, code, fault);
    if (!fault.any() && arv_camera_get_pixel_format(camera, fault) == code) return true;
  }
  return false;
}

Error not_offered(const CameraInfo& info, PixelFormat format) {
  return Error{ErrorCode::kUnsupported,
               info.uri + ": does not offer " + std::string(name(format)) +
                   ": see what it offers with arv-tool-0.8 values PixelFormat"};
}

/// Sets the requested size, and reads back the size and the format in force.
Result<std::uint32_t> settle_format(ArvCamera* camera, const StreamRequest& request,
                                    CameraInfo& info) {
  AravisFault fault;
  if (!request.size.empty()) {
    arv_camera_set_region(camera, 0, 0, request.size.width, request.size.height, fault);
    if (fault.any()) return fault.error(info.uri, "setting the picture's size");
  }
  const std::uint32_t code = arv_camera_get_pixel_format(camera, fault);
  info.format = format_of_pfnc(code);
  info.sample_bits = sample_bits_of_pfnc(code);
  if (info.format == PixelFormat::kUnknown)
    return Error{ErrorCode::kUnsupported,
                 info.uri +
                     ": sends a pixel format that mixrig does not read: choose another one by "
                     "arv-tool-0.8 control PixelFormat="};
  int x = 0, y = 0;
  arv_camera_get_region(camera, &x, &y, &info.size.width, &info.size.height, fault);
  if (fault.any() || declared_bytes(code, info.size) == 0)
    return fault.error(info.uri, "reading the picture's size");
  if (!request.size.empty() && info.size != request.size)
    return Error{ErrorCode::kUnsupported,
                 info.uri + ": does not offer the requested size: give another size_px"};
  return code;
}

bool available(ArvDevice* device, const char* feature) {
  AravisFault fault;
  return arv_device_is_feature_available(device, feature, fault) && !fault.any();
}

/// Switches a component; false if the camera does not have it, or does not let it be switched.
bool set_component(ArvDevice* device, const char* component, bool on) {
  AravisFault fault;
  arv_device_set_string_feature_value(device, "ComponentSelector", component, fault);
  if (fault.any()) return false;
  arv_device_set_boolean_feature_value(device, "ComponentEnable", on, fault);
  return !fault.any();
}

/// Selects the component Range, with Intensity and Confidence if buffers have several parts. Leaves
/// Range selected.
void choose_components(ArvCamera* camera) {
  ArvDevice* device = arv_camera_get_device(camera);
  if (!available(device, "ComponentSelector")) return;
  AravisFault fault;
  bool parts = !arv_camera_is_gv_device(camera);
  if (!parts && arv_camera_gv_is_multipart_supported(camera, fault) && !fault.any()) {
    arv_camera_gv_set_multipart(camera, TRUE, fault);
    parts = !fault.any();
  }
  for (const auto& [component, formats] :
       {std::pair{"Intensity", std::array{"Mono16", "Mono8"}},
        std::pair{"Confidence", std::array{"Confidence16", "Confidence8"}}}) {
    if (!set_component(device, component, parts) || !parts) continue;
    for (const char* format : formats) {
      arv_device_set_string_feature_value(device, "PixelFormat", format, fault);
      if (!fault.any()) break;
    }
  }
  (void)set_component(device, "Range", true);
}

/// Returns the possible values of a feature, such as "Line0, Line1".
std::string choices(ArvDevice* device, const char* feature) {
  AravisFault fault;
  guint count = 0;
  const char** names = arv_device_dup_available_enumeration_feature_values_as_strings(
      device, feature, &count, fault);
  std::string text;
  for (guint i = 0; names != nullptr && i < count; ++i)
    text += (i > 0 ? ", " : "") + std::string(names[i]);
  g_free(names);
  return text;
}

}  // namespace

Result<std::uint32_t> choose_aravis_format(ArvCamera* camera, const StreamRequest& request,
                                           CameraInfo& info) {
  AravisFault fault;
  arv_camera_stop_acquisition(camera, fault);  // may still run for a client that crashed
  if (request.format != PixelFormat::kUnknown && !set_first_format(camera, request.format))
    return not_offered(info, request.format);
  return settle_format(camera, request, info);
}

Result<std::uint32_t> choose_aravis_depth(ArvCamera* camera, const StreamRequest& request,
                                          CameraInfo& info) {
  AravisFault fault;
  arv_camera_stop_acquisition(camera, fault);
  choose_components(camera);
  if (!set_first_format(camera, PixelFormat::kDepth16))
    return not_offered(info, PixelFormat::kDepth16);
  return settle_format(camera, request, info);
}

Result<void> choose_aravis_trigger(ArvCamera* camera, const StreamRequest& request,
                                   CameraInfo& info) {
  AravisFault fault;
  info.hardware_trigger = request.hardware_trigger;
  if (request.hardware_trigger) {
    const std::string line = request.trigger_input.empty() ? "Line0" : request.trigger_input;
    arv_camera_set_trigger(camera, line.c_str(), fault);
    if (!fault.any()) return {};
    Error error = fault.error(info.uri, "setting the trigger to " + line);
    const std::string known = choices(arv_camera_get_device(camera), "TriggerSource");
    if (!known.empty()) error.context += ": give trigger_input one of " + known;
    return error;
  }
  arv_camera_clear_triggers(camera, fault);
  if (request.rate_hz > 0) {
    arv_camera_set_frame_rate(camera, request.rate_hz, fault);
    if (fault.any()) return fault.error(info.uri, "setting the frame rate");
  }
  info.rate_hz = arv_camera_get_frame_rate(camera, fault);
  return {};
}

namespace {

/// Returns "off", or the state by the first set of names that the camera has; empty if it has none.
std::string ptp_state(ArvDevice* device) {
  struct Names {
    const char *enable, *latch, *status;
  };
  for (const Names& names :
       {Names{"PtpEnable", "PtpDataSetLatch", "PtpStatus"},
        Names{"GevIEEE1588", "GevIEEE1588DataSetLatch", "GevIEEE1588Status"}}) {
    AravisFault fault;
    if (!available(device, names.enable)) continue;
    const bool on = arv_device_get_boolean_feature_value(device, names.enable, fault) != FALSE;
    if (fault.any() || !on) return "off";
    if (available(device, names.latch)) arv_device_execute_command(device, names.latch, fault);
    const char* state = arv_device_get_string_feature_value(device, names.status, fault);
    return state != nullptr && !fault.any() ? state : "on";
  }
  return {};
}

}  // namespace

void describe_aravis(ArvCamera* camera, CameraInfo& info) {
  AravisFault fault;
  const char* model = arv_camera_get_model_name(camera, fault);
  info.model = model != nullptr ? model : "";
  const char* serial = arv_camera_get_device_serial_number(camera, fault);
  info.serial = serial != nullptr ? serial : "";
  info.ptp = ptp_state(arv_camera_get_device(camera));
  double low = 0, high = 0;
  arv_camera_get_exposure_time_bounds(camera, &low, &high, fault);
  if (!fault.any() && high > low)
    info.controls.push_back({CameraControl::kExposure, low * 1e-6, high * 1e-6, 1e-6});
  arv_camera_get_gain_bounds(camera, &low, &high, fault);
  if (!fault.any() && high > low) info.controls.push_back({CameraControl::kGain, low, high, 0.1});
}

namespace {

std::string word(ArvDevice* device, const char* feature) {
  AravisFault fault;
  if (!available(device, feature)) return {};
  const char* text = arv_device_get_string_feature_value(device, feature, fault);
  return text != nullptr && !fault.any() ? text : "";
}

/// Returns the metres of one unit of coordinates. Errors: kUnsupported for a unit that is no
/// length.
Result<double> coordinate_unit(ArvDevice* device, const std::string& uri) {
  const std::string mode = word(device, "Scan3dOutputMode"),
                    unit = word(device, "Scan3dDistanceUnit");
  if (mode.starts_with("Disparity"))
    return Error{ErrorCode::kUnsupported, uri + ": sends disparities (Scan3dOutputMode " + mode +
                                              "): set it to a mode that sends depth"};
  if (unit.empty() || unit == "Millimeter") return 1e-3;
  if (unit == "Inch") return 0.0254;
  return Error{ErrorCode::kUnsupported,
               uri + ": its Scan3dDistanceUnit is " + unit + ": set it to Millimeter"};
}

/// Returns the value that means no measurement; empty if the camera reports that it has none.
std::optional<double> invalid_value(ArvDevice* device) {
  AravisFault fault;
  if (available(device, "Scan3dInvalidDataFlag") &&
      arv_device_get_boolean_feature_value(device, "Scan3dInvalidDataFlag", fault) == FALSE &&
      !fault.any())
    return std::nullopt;
  return feature(device, "Scan3dInvalidDataValue");
}

}  // namespace

Result<AravisDepth> aravis_depth_info(ArvCamera* camera, const std::string& uri,
                                      std::uint32_t code) {
  ArvDevice* device = arv_camera_get_device(camera);
  AravisFault fault;
  if (available(device, "Scan3dCoordinateSelector"))
    arv_device_set_string_feature_value(device, "Scan3dCoordinateSelector", "CoordinateC", fault);
  MIXRIG_ASSIGN(const double unit_m, coordinate_unit(device, uri));
  const auto scale = feature(device, "Scan3dCoordinateScale");
  if (!scale || !(*scale > 0) || !std::isfinite(*scale))
    return Error{ErrorCode::kDevice,
                 uri + ": does not report Scan3dCoordinateScale: its depth has no unit"};
  const double offset_m = feature(device, "Scan3dCoordinateOffset").value_or(0) * unit_m;
  const auto invalid = invalid_value(device);
  AravisDepth depth;
  if (is_float(code)) {
    depth.steps.metres_per_step = kFloatDepthStep_m;
    depth.floats = {.scale_m = *scale * unit_m, .offset_m = offset_m};
    if (invalid) depth.floats.invalid = static_cast<float>(*invalid);
  } else {
    depth.steps.metres_per_step = *scale * unit_m;
    depth.steps.offset_m = offset_m;
    if (invalid && *invalid >= 0 && *invalid <= 65535)
      depth.steps.unknown_steps = {static_cast<int>(*invalid)};
  }
  const std::string system = word(device, "Scan3dCoordinateSystem");
  if (system == "Spherical") depth.steps.meaning = DepthMeaning::kDistance;
  const auto focal = feature(device, "Scan3dFocalLength");
  const auto u = feature(device, "Scan3dPrincipalPointU"),
             v = feature(device, "Scan3dPrincipalPointV");
  if (focal && u && v && *focal > 0) depth.steps.intrinsics = DeviceIntrinsics{*focal, *u, *v};
  return depth;
}

}  // namespace mixrig::device
