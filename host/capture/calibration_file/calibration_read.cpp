// SPDX-License-Identifier: Apache-2.0
// Reads calibration.toml.
#include <algorithm>
#include <cmath>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/calibration_file/tables.h"

namespace mixrig::calibration_file {
namespace {

using config::Range;
using config::Table;

constexpr std::size_t kMaxCalibrationBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxKnots = 1000;
constexpr int kMaxPanTiltParameters = 64;
constexpr Range kDirection{-2, 2}, kDistance_m{-1e6, 1e6}, kDepthError_m{-1e3, 1e3};

Eigen::Vector3d parse_vector(const Table& table, const char* key, Range range) {
  const auto v = table.numbers(key, 3, 3, range);
  return {v[0], v[1], v[2]};
}

DepthError parse_depth_error(const Table& table, const char* camera) {
  DepthError error;
  error.camera = camera;
  error.camera = table.text_or("camera", error.camera);
  error.knots_m = table.numbers("knots_m", 2, kMaxKnots, kDistance_m);
  error.error_m =
      table.numbers("error_m", error.knots_m.size(), error.knots_m.size(), kDepthError_m);
  const bool growing = std::is_sorted(error.knots_m.begin(), error.knots_m.end(),
                                      [](double a, double b) { return a <= b; });
  if (!growing) table.fail("knots_m", "must grow: sort the knots, each one once");
  error.amplitude_m = table.number_or("amplitude_m", 0, {-1e9, 1e9});
  if (table.has("place_m")) {
    const auto place =
        table.numbers("place_m", error.place_m.size(), error.place_m.size(), kDepthError_m);
    std::copy(place.begin(), place.end(), error.place_m.begin());
  }
  const int parameters = static_cast<int>(error.knots_m.size() + 1 + error.place_m.size());
  error.covariance = parse_square(table, "covariance", parameters);
  error.residual_m = table.number_or("residual_m", 0, {0, 1e3});
  error.origin = parse_origin(table);
  return error;
}

PanTilt::Axis parse_axis(const Table& table) {
  PanTilt::Axis axis;
  axis.direction = parse_vector(table, "direction", kDirection);
  if (table.present() && std::abs(axis.direction.norm() - 1) > 1e-3)
    table.fail("direction", "must have length 1: divide it by its length");
  axis.point_m = parse_vector(table, "point_m", kDistance_m);
  axis.scale = table.number_or("scale", 1, {-100, 100});
  axis.offset_rad = table.number_or("offset_rad", 0, {-10, 10});
  axis.step_rad = table.number_or("step_rad", 0, {0, 1});
  return axis;
}

PanTilt parse_pan_tilt(const Table& table) {
  PanTilt unit;
  unit.pan = parse_axis(table.required_table("pan"));
  unit.tilt = parse_axis(table.required_table("tilt"));
  unit.head_from_target = parse_pose(table.required_table("head_from_target"));
  unit.repeatability_rad = table.number_or("repeatability_rad", 0, {0, 10});
  unit.repeatability_m = table.number_or("repeatability_m", 0, {0, 10});
  const auto rows = std::min<std::size_t>(table.size_of("covariance"), kMaxPanTiltParameters);
  unit.covariance = parse_square(table, "covariance", std::max(static_cast<int>(rows), 1));
  unit.residual_px = table.number_or("residual_px", 0, {0, 1e6});
  unit.views = table.integer_or("views", 0, {0, 1e9});
  unit.origin = parse_origin(table);
  return unit;
}

/// Whether the text is the calibration.yaml of earlier versions.
bool is_yaml(std::string_view text) {
  return text.starts_with("format:") || text.find("\nformat:") != std::string_view::npos;
}

}  // namespace

Result<Calibration> parse_calibration(std::string_view text, const std::string& name) {
  if (is_yaml(text))
    return Error{ErrorCode::kFormat,
                 name +
                     ": is YAML, which is not read any more: calibrate again, mixrig calibrate "
                     "writes calibration.toml"};
  MIXRIG_ASSIGN(config::Document document, config::Document::parse(text, name));
  const Table root = document.root();
  Calibration calibration;
  root.integer("format", {1, 1});
  const Table cameras = root.table("cameras"), poses = root.table("target_from");
  for (const std::string& key : cameras.keys())
    calibration.cameras.push_back(parse_camera(cameras.table(key), key));
  for (const std::string& key : poses.keys())
    calibration.poses.push_back(parse_calibrated_pose(poses.table(key), key));
  if (const Table depth = root.table("depth_error"); depth.present())
    calibration.depth_error = parse_depth_error(depth, "tof");
  if (const Table depth = root.table("depth_error2"); depth.present())
    calibration.depth_error2 = parse_depth_error(depth, "tof2");
  if (const Table unit = root.table("pan_tilt"); unit.present())
    calibration.pan_tilt = parse_pan_tilt(unit);
  MIXRIG_TRY(document.finish());
  return calibration;
}

Result<Calibration> read_calibration(const std::filesystem::path& path) {
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMaxCalibrationBytes));
  return parse_calibration(text, path.string());
}

}  // namespace mixrig::calibration_file
