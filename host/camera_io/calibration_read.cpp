// SPDX-License-Identifier: Apache-2.0
// calibration.yaml to Calibration.
#include <algorithm>

#include "host/camera_io/calibration.h"
#include "host/camera_io/yaml_table.h"

namespace mixrig::camera_io {
namespace {

constexpr int kMaxCount = 1'000'000'000;
constexpr double kFar_m = 1e6;

Origin read_origin(const YamlTable& table) {
  return {table.text_or("date", ""), table.text_or("tool_version", ""),
          table.text_or("input_hash", "")};
}

CalibratedCamera read_camera(const YamlTable& table, const std::string& name) {
  table.only({"model", "size_px", "parameters", "covariance", "residual_px", "views", "points",
              "date", "tool_version", "input_hash"});
  CalibratedCamera camera;
  camera.name = name;
  const std::string word = table.text("model");
  if (word != "pinhole" && word != "fisheye") table.fail("model", "must be pinhole or fisheye");
  const auto kind = word == "fisheye" ? geometry::LensKind::kFisheye : geometry::LensKind::kPinhole;
  const auto count = static_cast<std::size_t>(geometry::parameter_count(kind));
  const auto size = table.numbers("size_px", 2, 2);
  const auto values = table.numbers("parameters", count, count);
  const bool sized = size[0] >= 1 && size[0] <= 16384 && size[1] >= 1 && size[1] <= 16384;
  if (!sized) table.fail("size_px", "must be a width and a height from 1 to 16384");
  camera.model = geometry::make_camera(
      kind, sized ? Size{static_cast<int>(size[0]), static_cast<int>(size[1])} : Size{1, 1},
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<int>(count)));
  if (const auto valid = geometry::validate(camera.model); !valid)
    table.fail("parameters", valid.error().context);
  camera.covariance = table.square_or_empty("covariance", static_cast<int>(count));
  camera.residual_px = table.number_or("residual_px", 0, 0, 1e6);
  camera.views = table.has("views") ? table.integer("views", 0, kMaxCount) : 0;
  camera.points = table.has("points") ? table.integer("points", 0, kMaxCount) : 0;
  camera.origin = read_origin(table);
  return camera;
}

Eigen::Vector3d read_vector(const YamlTable& table, const std::string& key) {
  const auto v = table.numbers(key, 3, 3);
  return {v[0], v[1], v[2]};
}

geometry::Pose read_pose(const YamlTable& table) {
  const auto q = table.numbers("rotation_xyzw", 4, 4);
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (std::abs(rotation.norm() - 1) > 1e-3) table.fail("rotation_xyzw", "must have length 1");
  const Eigen::Vector3d translation_m = read_vector(table, "translation_m");
  if (translation_m.cwiseAbs().maxCoeff() > kFar_m)
    table.fail("translation_m", "must lie within a million metres");
  return {rotation.norm() > 0 ? rotation.normalized() : Eigen::Quaterniond::Identity(),
          translation_m};
}

CalibratedPose read_calibrated_pose(const YamlTable& table, const std::string& name) {
  table.only({"rotation_xyzw", "translation_m", "covariance", "residual_px", "views", "date",
              "tool_version", "input_hash"});
  CalibratedPose pose;
  pose.name = name;
  pose.target_from = read_pose(table);
  pose.covariance = table.square_or_empty("covariance", 6);
  pose.residual_px = table.number_or("residual_px", 0, 0, 1e6);
  pose.views = table.has("views") ? table.integer("views", 0, kMaxCount) : 0;
  pose.origin = read_origin(table);
  return pose;
}

DepthError read_depth_error(const YamlTable& table) {
  table.only({"camera", "knots_m", "error_m", "amplitude_m", "place_m", "covariance", "residual_m",
              "date", "tool_version", "input_hash"});
  DepthError error;
  constexpr std::size_t kMaxKnots = 1000;
  error.camera = table.text_or("camera", "tof");
  error.knots_m = table.numbers("knots_m", 2, kMaxKnots);
  error.error_m = table.numbers("error_m", error.knots_m.size(), error.knots_m.size());
  if (table.has("knots_m") && !std::is_sorted(error.knots_m.begin(), error.knots_m.end(),
                                              [](double a, double b) { return a <= b; }))
    table.fail("knots_m", "must grow");
  error.amplitude_m = table.number_or("amplitude_m", 0, -1e9, 1e9);
  if (table.has("place_m")) {
    const auto place = table.numbers("place_m", 5, 5);
    std::copy(place.begin(), place.end(), error.place_m.begin());
  }
  error.covariance =
      table.square_or_empty("covariance", static_cast<int>(error.knots_m.size()) + 6);
  error.residual_m = table.number_or("residual_m", 0, 0, 1e3);
  error.origin = read_origin(table);
  return error;
}

PanTilt::Axis read_axis(const YamlTable& table) {
  table.only({"direction", "point_m", "scale", "offset_rad"});
  PanTilt::Axis axis;
  axis.direction = read_vector(table, "direction");
  if (std::abs(axis.direction.norm() - 1) > 1e-3) table.fail("direction", "must have length 1");
  axis.point_m = read_vector(table, "point_m");
  axis.scale = table.number_or("scale", 1, -100, 100);
  axis.offset_rad = table.number_or("offset_rad", 0, -10, 10);
  return axis;
}

PanTilt read_pan_tilt(const YamlTable& table) {
  table.only({"pan", "tilt", "head_from_target", "repeatability_rad", "repeatability_m",
              "covariance_size", "covariance", "residual_px", "views", "date", "tool_version",
              "input_hash"});
  PanTilt unit;
  unit.pan = read_axis(table.required_table("pan"));
  unit.tilt = read_axis(table.required_table("tilt"));
  unit.head_from_target = read_pose(table.required_table("head_from_target"));
  unit.repeatability_rad = table.number_or("repeatability_rad", 0, 0, 10);
  unit.repeatability_m = table.number_or("repeatability_m", 0, 0, 10);
  if (table.has("covariance"))
    unit.covariance = table.square_or_empty("covariance", table.integer("covariance_size", 1, 64));
  unit.residual_px = table.number_or("residual_px", 0, 0, 1e6);
  unit.views = table.has("views") ? table.integer("views", 0, kMaxCount) : 0;
  unit.origin = read_origin(table);
  return unit;
}

}  // namespace

Result<Calibration> parse_calibration(const std::string& text, const std::string& name) {
  MIXRIG_ASSIGN(const auto document, YamlDocument::parse(text, name));
  const YamlTable root = document.root();
  Calibration calibration;
  root.only({"format", "cameras", "target_from", "depth_error", "pan_tilt"});
  root.integer("format", 1, 1);
  const YamlTable cameras = root.table("cameras"), poses = root.table("target_from");
  for (const std::string& key : cameras.keys())
    calibration.cameras.push_back(read_camera(cameras.table(key), key));
  for (const std::string& key : poses.keys())
    calibration.poses.push_back(read_calibrated_pose(poses.table(key), key));
  if (root.has("depth_error"))
    calibration.depth_error = read_depth_error(root.table("depth_error"));
  if (root.has("pan_tilt")) calibration.pan_tilt = read_pan_tilt(root.table("pan_tilt"));
  MIXRIG_TRY(document.finish());
  return calibration;
}

}  // namespace mixrig::camera_io
