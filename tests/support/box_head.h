// SPDX-License-Identifier: Apache-2.0
// A rig whose head stands in the box room: its true calibration, and the pictures of both cameras
// at given angles of the unit.
#pragma once

#include <numbers>
#include <vector>

#include "tests/support/axes_chain.h"
#include "tests/support/box_room.h"

namespace mixrig::test {

inline constexpr int kBoxColorWidth = 160, kBoxColorHeight = 90;
inline constexpr int kBoxTofWidth = 160, kBoxTofHeight = 120;

/// The axes are 2 cm apart and not perpendicular, the cameras stand beside them and are turned
/// against them, and the encoder of the pan axis is off.
inline calibration_file::Calibration box_calibration() {
  const auto turned = [](double x_rad, double y_rad, double z_rad) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(z_rad, Eigen::Vector3d::UnitZ()) *
                              Eigen::AngleAxisd(y_rad, Eigen::Vector3d::UnitY()) *
                              Eigen::AngleAxisd(x_rad, Eigen::Vector3d::UnitX()));
  };
  calibration_file::Calibration known;
  geometry::CameraModel target, tof;
  target.pinhole = {{kBoxColorWidth, kBoxColorHeight}, 105, 105, 79.5, 44.5};
  tof.pinhole = {{kBoxTofWidth, kBoxTofHeight}, 144, 144, 79.5, 59.5};
  known.cameras = {{"target", target, {}, 0, 0, 0, {}}, {"tof", tof, {}, 0, 0, 0, {}}};
  known.poses.push_back({"tof", {turned(0.01, -0.02, 0.005), {0.06, 0.01, -0.01}}, {}, 0, 0, {}});
  calibration_file::PanTilt& unit = known.pan_tilt.emplace();
  unit.pan.offset_rad = 0.012;
  unit.tilt.direction = Eigen::Vector3d(1, 0, 0.006).normalized();
  unit.tilt.point_m = {0, 0.02, 0};
  unit.pan.step_rad = unit.tilt.step_rad = 185.1428 / 3600 * std::numbers::pi / 180;
  unit.head_from_target = {turned(-std::numbers::pi / 2 + 0.015, 0.01, -0.01), {-0.03, 0.05, 0.07}};
  return known;
}

/// Pictures of the cameras of box_calibration() in the box room.
class BoxHead {
 public:
  std::vector<std::uint8_t> yuyv(double pan_rad, double tilt_rad) const {
    return color_.yuyv(base_from_target(*known_.pan_tilt, pan_rad, tilt_rad));
  }
  std::vector<std::uint16_t> distances_mm(double pan_rad, double tilt_rad) const {
    return tof_.distances_mm(base_from_target(*known_.pan_tilt, pan_rad, tilt_rad) *
                             isometry(known_.pose("tof")->target_from));
  }

 private:
  const calibration_file::Calibration known_ = box_calibration();
  const BoxCamera color_{kBoxColorWidth, kBoxColorHeight, 105, 79.5, 44.5};
  const BoxCamera tof_{kBoxTofWidth, kBoxTofHeight, 144, 79.5, 59.5};
};

}  // namespace mixrig::test
