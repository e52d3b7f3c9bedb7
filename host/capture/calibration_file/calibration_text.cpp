// SPDX-License-Identifier: Apache-2.0
// Writes calibration.toml.
#include "host/capture/calibration_file/calibration.h"
#include "host/capture/calibration_file/tables.h"

namespace mixrig::calibration_file {
namespace {

using config::Writer;

Writer depth_error_table(const DepthError& error) {
  Writer table;
  table.set("camera", error.camera);
  table.set("knots_m", error.knots_m).set("error_m", error.error_m);
  table.set("amplitude_m", error.amplitude_m).set("place_m", error.place_m);
  table.set("residual_m", error.residual_m);
  set_origin(table, error.origin, error.covariance);
  return table;
}

Writer axis_table(const PanTilt::Axis& axis) {
  Writer table;
  table.set("direction", std::span<const double>(axis.direction.data(), 3));
  table.set("point_m", std::span<const double>(axis.point_m.data(), 3));
  table.set("scale", axis.scale).set("offset_rad", axis.offset_rad);
  table.set("step_rad", axis.step_rad);
  return table;
}

Writer pan_tilt_table(const PanTilt& unit) {
  Writer table;
  table.set("pan", axis_table(unit.pan)).set("tilt", axis_table(unit.tilt));
  table.set("head_from_target", pose_table(unit.head_from_target));
  table.set("repeatability_rad", unit.repeatability_rad);
  table.set("repeatability_m", unit.repeatability_m);
  table.set("residual_px", unit.residual_px).set("views", unit.views);
  set_origin(table, unit.origin, unit.covariance);
  return table;
}

}  // namespace

std::string calibration_text(const Calibration& calibration) {
  Writer root, cameras, poses;
  root.set("format", 1);
  for (const auto& camera : calibration.cameras) cameras.set(camera.name, camera_table(camera));
  for (const auto& pose : calibration.poses) poses.set(pose.name, pose_table(pose));
  if (!calibration.cameras.empty()) root.set("cameras", std::move(cameras));
  if (!calibration.poses.empty()) root.set("target_from", std::move(poses));
  if (calibration.depth_error) root.set("depth_error", depth_error_table(*calibration.depth_error));
  if (calibration.depth_error2)
    root.set("depth_error2", depth_error_table(*calibration.depth_error2));
  if (calibration.pan_tilt) root.set("pan_tilt", pan_tilt_table(*calibration.pan_tilt));
  return "# Written by mixrig calibrate. Metres, radians, pixels; "
         "docs/reference/calibration_file.md has the keys.\n" +
         root.text();
}

}  // namespace mixrig::calibration_file
