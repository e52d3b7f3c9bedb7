// SPDX-License-Identifier: Apache-2.0
// Lengths in the file are shares of the sensor's width and height; pixel (0, 0) there is the corner
// of the sensor. A mode reads a part of the sensor and bins it.
#include "host/capture/take/foreign/azure_calibration.h"

#include <array>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace mixrig::take {
namespace {

using nlohmann::json;

/// A mode of the depth camera: pixels of the sensor that one pixel bins, and the first pixel.
struct DepthMode {
  Size size;
  double bin, left, top;
};
constexpr DepthMode kDepthModes[] = {{{320, 288}, 2, 192, 180},
                                     {{640, 576}, 1, 192, 180},
                                     {{512, 512}, 2, 0, 0},
                                     {{1024, 1024}, 1, 0, 0}};

struct SensorPart {
  double scale, left, top;
};

std::optional<SensorPart> depth_part(Size size) {
  for (const DepthMode& mode : kDepthModes)
    if (mode.size == size) return SensorPart{1 / mode.bin, mode.left, mode.top};
  return std::nullopt;
}

/// The colour camera reads all columns, and rows around the middle in modes of 16:9.
std::optional<SensorPart> color_part(Size size, Size sensor) {
  const double scale = static_cast<double>(size.width) / sensor.width;
  const double top = 0.5 * (sensor.height - size.height / scale);
  if (scale <= 0 || scale > 1 || top < -1) return std::nullopt;
  return SensorPart{scale, 0, top};
}

/// Numbers of an array of exactly N; nullopt for anything else.
template <std::size_t N>
std::optional<std::array<double, N>> numbers(const json& from, const char* key) {
  const auto at = from.find(key);
  if (at == from.end() || !at->is_array() || at->size() != N) return std::nullopt;
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    if (!(*at)[i].is_number()) return std::nullopt;
    values[i] = (*at)[i].template get<double>();
  }
  return values;
}

struct SensorCamera {
  std::array<double, 14> p{};  ///< cx cy fx fy k1..k6, centre of distortion, p2 p1
  Size sensor;
  geometry::Pose from_depth;
};

Result<SensorCamera> sensor_camera(const json& file, const char* location) {
  const auto bad = [&](const char* what) {
    return Error{ErrorCode::kFormat, fmt::format("calibration.json: {}: {}", location, what)};
  };
  const json* found = nullptr;
  if (file.is_object() && file.contains("CalibrationInformation") &&
      file["CalibrationInformation"].is_object() &&
      file["CalibrationInformation"].contains("Cameras"))
    for (const json& camera : file["CalibrationInformation"]["Cameras"])
      if (camera.is_object() && camera.contains("Location") && camera["Location"] == location)
        found = &camera;
  if (found == nullptr || !found->contains("Intrinsics") || !found->contains("Rt") ||
      !(*found)["Intrinsics"].is_object() || !(*found)["Rt"].is_object())
    return bad("there is no such camera");
  SensorCamera camera;
  const auto parameters = numbers<14>((*found)["Intrinsics"], "ModelParameters");
  const auto rotation = numbers<9>((*found)["Rt"], "Rotation");
  const auto translation = numbers<3>((*found)["Rt"], "Translation");
  if (!parameters || !rotation || !translation) return bad("14, 9 and 3 numbers are needed");
  const auto side = [&](const char* key) {
    const auto at = found->find(key);
    const double value = at != found->end() && at->is_number() ? at->get<double>() : 0;
    return value >= 1 && value <= 65536 ? static_cast<int>(value) : 0;
  };
  camera.p = *parameters, camera.sensor = {side("SensorWidth"), side("SensorHeight")};
  if (camera.sensor.empty()) return bad("SensorWidth and SensorHeight are needed");
  MIXRIG_ASSIGN(
      camera.from_depth,
      geometry::pose_from_matrix(
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation->data()),
          Eigen::Map<const Eigen::Vector3d>(translation->data())));
  return camera;
}

Result<geometry::CameraModel> model_of(const SensorCamera& camera, Size size,
                                       std::optional<SensorPart> part, const char* what) {
  if (!part)
    return Error{ErrorCode::kUnsupported,
                 fmt::format("{} pictures of {}x{}: no mode of this camera has that size", what,
                             size.width, size.height)};
  const auto& p = camera.p;
  const auto pixel = [&](double share, int sensor, double first) {
    return (share * sensor - first) * part->scale - 0.5;
  };
  geometry::CameraModel model;
  model.pinhole = {
      size, p[2] * camera.sensor.width * part->scale, p[3] * camera.sensor.height * part->scale,
      pixel(p[0], camera.sensor.width, part->left), pixel(p[1], camera.sensor.height, part->top)};
  model.lens = geometry::Lens({p[4], p[5], p[13], p[12], p[6], p[7], p[8], p[9]});
  if (const auto valid = geometry::validate(model); !valid)
    return Error{ErrorCode::kData,
                 fmt::format("calibration.json: {}: {}", what, valid.error().context)};
  return model;
}

}  // namespace

Result<AzureCameras> parse_azure_calibration(std::string_view text, Size color_px, Size depth_px) {
  // The attachment may end with zero bytes.
  text = text.substr(0, text.find('\0'));
  const json file = json::parse(text, nullptr, false);
  if (file.is_discarded())
    return Error{ErrorCode::kFormat, "calibration.json is not JSON: the recording is damaged"};
  MIXRIG_ASSIGN(const SensorCamera depth, sensor_camera(file, "CALIBRATION_CameraLocationD0"));
  MIXRIG_ASSIGN(const SensorCamera color, sensor_camera(file, "CALIBRATION_CameraLocationPV0"));
  AzureCameras cameras;
  MIXRIG_ASSIGN(cameras.depth, model_of(depth, depth_px, depth_part(depth_px), "depth"));
  MIXRIG_ASSIGN(cameras.color,
                model_of(color, color_px, color_part(color_px, color.sensor), "colour"));
  cameras.color_from_depth = color.from_depth * geometry::inverse(depth.from_depth);
  return cameras;
}

}  // namespace mixrig::take
