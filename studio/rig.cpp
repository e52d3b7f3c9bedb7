// SPDX-License-Identifier: Apache-2.0
// The rig presets.
#include "studio/rig.h"

#include <algorithm>
#include <cmath>

#include "hal/base/angles.h"

namespace mixrig::studio {
namespace {

Optics optics_of(Size size, double field_deg, std::array<double, 5> distortion, double off_x = 0,
                 double off_y = 0) {
  const double f = 0.5 * size.width / std::tan(0.5 * field_deg * kDeg);
  return {size, f, f, 0.5 * (size.width - 1) + off_x, 0.5 * (size.height - 1) + off_y, distortion};
}

/// A camera `x_m` to the right of and `y_m` below the target camera, rotated by `turn_deg`.
geometry::Pose mounted(double x_m, double y_m, double turn_deg) {
  const Eigen::AngleAxisd about(turn_deg * kDeg, Eigen::Vector3d(0.35, 1, 0.2).normalized());
  return {Eigen::Quaterniond(about), {x_m, y_m, 0.012}};
}

}  // namespace

TofSensor tof_sensor(RigPreset rig) {
  TofSensor s;
  switch (rig) {
    case RigPreset::kSr3000:  // Mesa SR3000: 176 x 144, 47.5 x 39.6 degrees, 20 MHz
      s.optics = optics_of({176, 144}, 47.5, {-0.18, 0.10, 0.0006, -0.0004, 0}, 1.2, -0.8);
      s.target_from_tof = mounted(0.0, 0.065, 0.9);
      s.fine_hz = 20e6, s.exposure_s = 0.020;
      s.signal_e = 300e3F, s.background_e = 3000, s.read_noise_e = 60, s.full_well_e = 1.2e6F;
      s.least_amplitude_e = 250, s.wiggle_rad = 0.0126F;
      s.noise = {0.00095, 0.00197, 0.00069};
      break;
    case RigPreset::kKinect2:  // 512 x 424, 70.6 x 60 degrees, 80 and 16 MHz
      s.optics = optics_of({512, 424}, 70.0, {0.09, -0.27, 0, 0, 0.10}, -1.5, 2.0);
      s.target_from_tof = mounted(0.075, 0.01, -0.7);
      s.fine_hz = 80e6, s.coarse_hz = 16e6, s.exposure_s = 0.024;
      s.signal_e = 46e3F, s.background_e = 200, s.read_noise_e = 12, s.full_well_e = 160e3F;
      s.least_amplitude_e = 45, s.wiggle_rad = 0.020F;
      s.noise = {0.00034, 0.00174, 0.00018};
      break;
    case RigPreset::kHelios2:  // Lucid Helios2: 640 x 480, 69 x 51 degrees
      s.optics = optics_of({640, 480}, 69.0, {-0.05, 0.02, 0.0003, 0.0002, 0}, 0.7, 1.1);
      s.target_from_tof = mounted(-0.085, 0.0, 0.6);
      s.fine_hz = 70e6, s.coarse_hz = 15e6, s.exposure_s = 0.016;
      s.signal_e = 140e3F, s.background_e = 400, s.read_noise_e = 15, s.full_well_e = 500e3F;
      s.least_amplitude_e = 110, s.wiggle_rad = 0.015F;
      s.noise = {0.00014, 0.00125, 0.00007};
      s.unit_m = 0.0005;
      break;
  }
  return s;
}

TofSensor second_sensor(RigPreset rig, RigPreset first) {
  constexpr double kGap_s = 1e-3;
  const TofSensor beside = tof_sensor(first);
  TofSensor s = tof_sensor(rig);
  const Eigen::Vector3d at = beside.target_from_tof.translation_m;
  s.target_from_tof = {beside.target_from_tof.rotation.conjugate(), {-at.x(), -at.y(), at.z()}};
  const double left_s = 1 / kFrameRate_hz - beside.exposure_s - 2 * kGap_s;
  const double share = std::min(1.0, left_s / s.exposure_s);
  s.exposure_s *= share;
  s.signal_e *= static_cast<float>(share), s.background_e *= static_cast<float>(share);
  s.noise.linear /= std::sqrt(share), s.noise.quadratic_per_m /= share;
  s.delay_s = -0.5 / kFrameRate_hz;
  return s;
}

TofSensor with_realism(TofSensor s, RigPreset rig, const Realism& realism) {
  const bool old = rig == RigPreset::kSr3000;
  if (realism.harmonics) s.second_rad = 0.3F * s.wiggle_rad;
  if (realism.stray_light) s.stray = old ? 0.02F : 0.01F;
  if (realism.pixel_offsets) s.offset_sigma_m = old ? 0.008F : 0.003F;
  if (realism.warm_up) s.warm_up_m = old ? 0.040F : 0.015F;
  if (realism.late_depth) s.delay_s += 0.006;
  s.multipath = realism.multipath;
  return s;
}

Optics target_optics(RigPreset rig, Size size_px) {
  if (rig == RigPreset::kSr3000)
    return optics_of(size_px, 42.0, {-0.12, 0.05, 0.0004, -0.0006, 0}, 0.004 * size_px.width,
                     -0.003 * size_px.height);
  return optics_of(size_px, 56.0, {-0.12, 0.05, 0.0004, -0.0006, 0}, 0.004 * size_px.width,
                   -0.003 * size_px.height);
}

FisheyeInfo fisheye_camera() {
  constexpr Size kSize{1280, 1024};
  FisheyeOptics o;
  o.size_px = kSize;
  o.field_rad = 185 * kDeg;
  o.f_px = 0.5 * kSize.height / (0.5 * o.field_rad);
  o.cx_px = 0.5 * (kSize.width - 1), o.cy_px = 0.5 * (kSize.height - 1);
  o.k1 = -0.012, o.k2 = 0.0015;
  return {o, mounted(0.07, 0.08, 0.4)};
}

FisheyeOptics scaled(const FisheyeOptics& optics, Size size_px) {
  const double factor = std::min(static_cast<double>(size_px.width) / optics.size_px.width,
                                 static_cast<double>(size_px.height) / optics.size_px.height);
  const auto centre = [&](double at_px, int from, int to) {
    return factor * (at_px - 0.5 * (from - 1)) + 0.5 * (to - 1);
  };
  FisheyeOptics out = optics;
  out.size_px = size_px;
  out.f_px = factor * optics.f_px;
  out.cx_px = centre(optics.cx_px, optics.size_px.width, size_px.width);
  out.cy_px = centre(optics.cy_px, optics.size_px.height, size_px.height);
  return out;
}

Optics with_lens_error(Optics optics, double error_px) {
  const double x = 0.5 * optics.size_px.width / optics.fx_px;
  const double y = 0.5 * optics.size_px.height / optics.fy_px;
  const double at_corner = error_px / optics.fx_px / std::pow(x * x + y * y, 2);
  optics.prism = {0.8 * at_corner, -0.6 * at_corner};
  return optics;
}

Optics without_distortion(Optics optics) {
  optics.distortion = {};
  optics.prism = {};
  return optics;
}

}  // namespace mixrig::studio
