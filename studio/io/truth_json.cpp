// SPDX-License-Identifier: Apache-2.0
#include "studio/io/truth_json.h"

#include <nlohmann/json.hpp>

namespace mixrig::studio_io {

using nlohmann::json;

namespace {

json axis(const studio::TurnAxis& axis) {
  return {{"direction", to_json(axis.direction)},
          {"point_m", to_json(axis.point_m)},
          {"scale", axis.scale}};
}

}  // namespace

json to_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

json to_json(const geometry::Pose& pose) {
  const Eigen::Vector4d q = pose.rotation.coeffs();
  return {{"rotation_xyzw", {q[0], q[1], q[2], q[3]}},
          {"translation_m", to_json(pose.translation_m)}};
}

json to_json(const studio::Optics& o) {
  return {{"fx", o.fx_px}, {"fy", o.fy_px}, {"cx", o.cx_px}, {"cy", o.cy_px}, {"k", o.distortion}};
}

json to_json(const studio::PanTiltUnit& unit) {
  return {{"pan", axis(unit.pan)},
          {"tilt", axis(unit.tilt)},
          {"repeatability_rad", unit.repeatability_rad}};
}

json to_json(const studio::MocapSystem& system) {
  return {{"rate_hz", system.rate_hz},
          {"clock_offset_s", system.clock_offset_s},
          {"clock_drift", system.clock_drift},
          {"delay_s", system.delay_s},
          {"position_sigma_m", system.position_sigma_m},
          {"rotation_sigma_rad", system.rotation_sigma_rad},
          {"lost_share", system.lost_share},
          {"marker_sigma_m", system.marker_sigma_m},
          {"hidden_share", system.hidden_share},
          {"body_from_target", to_json(system.body_from_target)}};
}

}  // namespace mixrig::studio_io
