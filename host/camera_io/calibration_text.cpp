// SPDX-License-Identifier: Apache-2.0
// Calibration to calibration.yaml.
#include <fstream>

#include "host/camera_io/calibration.h"
#include "host/camera_io/yaml_text.h"

namespace mixrig::camera_io {
namespace {

using Lines = std::string;

Lines origin_lines(const Origin& origin, const std::string& indent) {
  return indent + "date: " + yaml_string(origin.date) + "\n" + indent +
         "tool_version: " + yaml_string(origin.tool_version) + "\n" + indent +
         "input_hash: " + yaml_string(origin.input_hash) + "\n";
}

Lines covariance_lines(const Eigen::MatrixXd& covariance, const std::string& indent) {
  if (covariance.size() == 0) return {};
  return indent + "covariance:\n" + rows(covariance, indent + "  ");
}

Lines camera_lines(const CalibratedCamera& camera) {
  const auto kind = geometry::kind_of(camera.model);
  const Size size = geometry::size_px(camera.model);
  std::string names;
  for (const auto name : geometry::parameter_names(kind)) names += " " + std::string(name);
  const std::string in = "    ";
  return "  " + yaml_string(camera.name) + ":\n" + in + "model: " + std::string(name_of(kind)) +
         "\n" + in + "size_px: [" + std::to_string(size.width) + ", " +
         std::to_string(size.height) + "]\n" + in +
         "parameters: " + list(geometry::parameters_of(camera.model)) + "  #" + names + "\n" + in +
         "residual_px: " + digits(camera.residual_px) + "\n" + in +
         "views: " + std::to_string(camera.views) + "\n" + in +
         "points: " + std::to_string(camera.points) + "\n" + origin_lines(camera.origin, in) +
         covariance_lines(camera.covariance, in);
}

Lines pose_lines(const geometry::Pose& pose, const std::string& indent) {
  const Eigen::Vector4d xyzw = pose.rotation.coeffs();
  return indent + "rotation_xyzw: " + list(xyzw.data(), 4) + "\n" + indent +
         "translation_m: " + list(pose.translation_m.data(), 3) + "\n";
}

Lines pose_entry_lines(const CalibratedPose& pose) {
  const std::string in = "    ";
  return "  " + yaml_string(pose.name) + ":\n" + pose_lines(pose.target_from, in) + in +
         "residual_px: " + digits(pose.residual_px) + "\n" + in +
         "views: " + std::to_string(pose.views) + "\n" + origin_lines(pose.origin, in) +
         covariance_lines(pose.covariance, in);
}

Lines depth_error_lines(const DepthError& error) {
  const std::string in = "  ";
  return "depth_error:\n" + in + "camera: " + yaml_string(error.camera) + "\n" + in +
         "knots_m: " + list(error.knots_m.data(), error.knots_m.size()) + "\n" + in +
         "error_m: " + list(error.error_m.data(), error.error_m.size()) + "\n" + in +
         "amplitude_m: " + digits(error.amplitude_m) + "\n" + in +
         "place_m: " + list(error.place_m.data(), error.place_m.size()) + "  # u v u^2 u*v v^2\n" +
         in + "residual_m: " + digits(error.residual_m) + "\n" + origin_lines(error.origin, in) +
         covariance_lines(error.covariance, in);
}

Lines axis_lines(const char* name, const PanTilt::Axis& axis) {
  const std::string in = "    ";
  return std::string("  ") + name + ":\n" + in + "direction: " + list(axis.direction.data(), 3) +
         "\n" + in + "point_m: " + list(axis.point_m.data(), 3) + "\n" + in +
         "scale: " + digits(axis.scale) + "\n" + in + "offset_rad: " + digits(axis.offset_rad) +
         "\n";
}

Lines pan_tilt_lines(const PanTilt& unit) {
  const std::string in = "  ";
  const std::string size =
      unit.covariance.size() > 0
          ? in + "covariance_size: " + std::to_string(unit.covariance.rows()) + "\n"
          : "";
  return "pan_tilt:\n" + axis_lines("pan", unit.pan) + axis_lines("tilt", unit.tilt) + in +
         "head_from_target:\n" + pose_lines(unit.head_from_target, "    ") + in +
         "repeatability_rad: " + digits(unit.repeatability_rad) + "\n" + in +
         "repeatability_m: " + digits(unit.repeatability_m) + "\n" + in +
         "residual_px: " + digits(unit.residual_px) + "\n" + in +
         "views: " + std::to_string(unit.views) + "\n" + origin_lines(unit.origin, in) + size +
         covariance_lines(unit.covariance, in);
}

}  // namespace

std::string calibration_text(const Calibration& calibration) {
  std::string text =
      "# Written by mixrig calibrate. Metres, radians, pixels; (0, 0) is the centre of the "
      "top-left "
      "pixel.\nformat: 1\n";
  if (!calibration.cameras.empty()) text += "cameras:\n";
  for (const auto& camera : calibration.cameras) text += camera_lines(camera);
  if (!calibration.poses.empty()) text += "target_from:\n";
  for (const auto& pose : calibration.poses) text += pose_entry_lines(pose);
  if (calibration.depth_error) text += depth_error_lines(*calibration.depth_error);
  if (calibration.pan_tilt) text += pan_tilt_lines(*calibration.pan_tilt);
  return text;
}

}  // namespace mixrig::camera_io
