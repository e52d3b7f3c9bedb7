// SPDX-License-Identifier: Apache-2.0
// The rig of a seed.
#include "studio/rig_of_seed.h"

#include <cmath>
#include <numbers>

#include "hal/base/angles.h"
#include "studio/sensors/noise.h"
#include "studio/sensors/tof.h"

namespace mixrig::studio {
namespace {

/// Deviations from the preset: uniform values in [-size, size]. The values of a seed differ by
/// `size` alone.
class Tolerance {
 public:
  Tolerance(unsigned seed, double size) : size_(size), seed_(seed) {}
  double operator()() { return size_ * (2.0 * uniform(hash_key(seed_, 0xB0A2D, ++count_)) - 1); }
  void set_size(double size) { size_ = size; }
  Eigen::Vector3d vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  double size_;
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
  const Eigen::AngleAxisd turn(w.norm(), w.stableNormalized());
  const Eigen::Vector3d shift = 0.004 * t.vector();
  return {Eigen::Quaterniond(turn) * pose.rotation, pose.translation_m + shift};
}

FisheyeOptics varied(FisheyeOptics optics, Tolerance& t) {
  optics.f_px *= 1 + 0.01 * t();
  optics.cx_px += 6 * t();
  optics.cy_px += 6 * t();
  optics.k1 += 0.004 * t(), optics.k2 += 0.0005 * t();
  return optics;
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

double phase_per_m(const TofSensor& sensor) {
  return 4 * std::numbers::pi * sensor.fine_hz / kLight_m_s;
}

}  // namespace

Rig rig_of_seed(RigPreset preset, unsigned seed, Size target_px, double tolerance,
                std::optional<RigPreset> second) {
  Tolerance t(seed, tolerance);
  Rig rig;
  rig.target = varied(target_optics(preset, target_px), t);
  rig.tof = tof_sensor(preset);
  rig.tof.optics = varied(rig.tof.optics, t);
  rig.tof.target_from_tof = varied(rig.tof.target_from_tof, t);
  const FisheyeInfo fisheye = fisheye_camera();
  rig.fisheye = varied(fisheye.optics, t);
  rig.target_from_fisheye = varied(fisheye.target_from_fisheye, t);
  t.set_size(1);
  rig.pan_tilt = pan_tilt_of(t);
  if (!second) return rig;
  t.set_size(tolerance);
  rig.tof2 = second_sensor(*second, preset);
  rig.tof2->optics = varied(rig.tof2->optics, t);
  rig.tof2->target_from_tof = varied(rig.tof2->target_from_tof, t);
  return rig;
}

double depth_error_m(const TofSensor& sensor, double distance_m) {
  const double per_m = phase_per_m(sensor);
  const double first = sensor.wiggle_rad * std::sin(4 * per_m * distance_m + 0.7F) / per_m;
  if (sensor.second_rad == 0) return first;
  return first + sensor.second_rad * std::sin(8 * per_m * distance_m + 0.3F) / per_m;
}

void set_depth_error(TofSensor& sensor, double most_m) {
  sensor.wiggle_rad = static_cast<float>(most_m * phase_per_m(sensor));
}

}  // namespace mixrig::studio
