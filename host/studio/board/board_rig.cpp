// SPDX-License-Identifier: Apache-2.0
// A rig with manufacturing tolerances.
#include "host/studio/board/board_rig.h"

#include <cmath>
#include <numbers>

#include "host/studio/sensors/noise.h"
#include "host/studio/stage/layout.h"

namespace mixrig::studio {
namespace {

constexpr double kDeg = std::numbers::pi / 180;
constexpr double kLight_m_s = 299792458.0;
constexpr Size kFisheye_px{1280, 1024};

/// Deviations from the preset: uniform values in [-1, 1].
class Tolerance {
 public:
  explicit Tolerance(unsigned seed) : seed_(seed) {}
  double operator()() { return 2.0 * uniform(hash_key(seed_, 0xB0A2D, ++count_)) - 1; }
  Eigen::Vector3d vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::uint64_t seed_, count_ = 0;
};

Optics varied(Optics optics, Tolerance& t) {
  const double f = 1 + 0.01 * t();
  optics.fx_px *= f, optics.fy_px *= f * (1 + 0.001 * t());
  optics.cx_px += 0.006 * optics.size_px.width * t();
  optics.cy_px += 0.006 * optics.size_px.height * t();
  for (double& k : optics.distortion) k *= 1 + 0.15 * t();
  return optics;
}

geometry::Pose varied(const geometry::Pose& pose, Tolerance& t) {
  const Eigen::Vector3d w = 0.6 * kDeg * t.vector();
  const Eigen::AngleAxisd turn(w.norm(), w.normalized());
  const Eigen::Vector3d shift = 0.004 * t.vector();
  return {Eigen::Quaterniond(turn) * pose.rotation, pose.translation_m + shift};
}

FisheyeOptics fisheye_of(Tolerance& t) {
  FisheyeOptics o;
  o.size_px = kFisheye_px;
  o.field_rad = 185 * kDeg;
  o.f_px = 0.5 * kFisheye_px.height / (0.5 * o.field_rad) * (1 + 0.01 * t());
  o.cx_px = 0.5 * (kFisheye_px.width - 1) + 6 * t();
  o.cy_px = 0.5 * (kFisheye_px.height - 1) + 6 * t();
  o.k1 = -0.012 + 0.004 * t(), o.k2 = 0.0015 + 0.0005 * t();
  return o;
}

/// The axes are up to 3 mm apart and not exactly perpendicular.
PanTiltUnit pan_tilt_of(Tolerance& t) {
  const auto misaligned = [&](const Eigen::Vector3d& axis) {
    return Eigen::Vector3d(axis + 0.008 * t.vector()).normalized();
  };
  PanTiltUnit unit;
  unit.pan.direction = misaligned(-Eigen::Vector3d::UnitY());
  unit.tilt.direction = misaligned(Eigen::Vector3d::UnitX());
  // The axes' nearest points are the ends of their common perpendicular.
  const Eigen::Vector3d across = unit.pan.direction.cross(unit.tilt.direction).normalized();
  unit.pan.point_m = Eigen::Vector3d(0, 0.06, -0.05) + 0.006 * t.vector();
  unit.tilt.point_m = unit.pan.point_m + 0.003 * t() * across;
  unit.pan.scale = 1 + 0.002 * t(), unit.tilt.scale = 1 + 0.002 * t();
  unit.step_rad = kPanStep_rad;
  unit.repeatability_rad = 0.003 * kDeg;
  return unit;
}

geometry::Pose turn_about(const TurnAxis& axis, double reported_rad) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(axis.scale * reported_rad, axis.direction));
  return {turn, axis.point_m - turn * axis.point_m};
}

double radius_of(const FisheyeOptics& o, double angle) {
  return o.f_px * angle * (1 + angle * angle * (o.k1 + angle * angle * o.k2));
}

}  // namespace

bool fisheye_ray(const FisheyeOptics& o, double u_px, double v_px, Eigen::Vector3d& ray) {
  const double x = u_px - o.cx_px, y = v_px - o.cy_px, r = std::hypot(x, y);
  if (r > radius_of(o, 0.5 * o.field_rad)) return false;
  double angle = r / o.f_px;
  for (int i = 0; i < 8; ++i) {
    const double a2 = angle * angle, slope = o.f_px * (1 + a2 * (3 * o.k1 + 5 * a2 * o.k2));
    angle -= (radius_of(o, angle) - r) / slope;
  }
  const double scale = r > 0 ? std::sin(angle) / r : 0;
  ray = {x * scale, y * scale, std::cos(angle)};
  return true;
}

BoardRig make_board_rig(RigPreset preset, unsigned seed, Size target_px, double depth_error_m) {
  Tolerance t(seed);
  BoardRig rig;
  rig.target = varied(target_optics(preset, target_px), t);
  rig.tof = tof_sensor(preset);
  rig.tof.optics = varied(rig.tof.optics, t);
  rig.tof.target_from_tof = varied(rig.tof.target_from_tof, t);
  rig.tof.wiggle_rad =
      static_cast<float>(depth_error_m * 4 * std::numbers::pi * rig.tof.fine_hz / kLight_m_s);
  rig.fisheye = fisheye_of(t);
  rig.target_from_fisheye = varied(fisheye_camera().target_from_fisheye, t);
  rig.pan_tilt = pan_tilt_of(t);
  return rig;
}

geometry::Pose rest_from_turned(const PanTiltUnit& unit, double pan_rad, double tilt_rad) {
  return turn_about(unit.pan, pan_rad) * turn_about(unit.tilt, tilt_rad);
}

double depth_error_m(const TofSensor& sensor, double distance_m) {
  const double per_m = 4 * std::numbers::pi * sensor.fine_hz / kLight_m_s;
  return sensor.wiggle_rad * std::sin(4 * per_m * distance_m + 0.7F) / per_m;
}

}  // namespace mixrig::studio
