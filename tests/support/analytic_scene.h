// SPDX-License-Identifier: Apache-2.0
// A small exact world for tests: a room, a box, a pole and a person of capsules, ray-cast without
// any code of the pipeline. Cameras are ideal pinholes (the plate may have a radial lens).
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"

namespace mixrig::test {

struct Camera {
  Size size_px;
  double f_px = 0;             ///< focal length; square pixels, centre in the middle
  Eigen::Vector3d position_m;  ///< world; axes parallel to the target camera's
  double k1 = 0;               ///< radial distortion of the plate
  double cx_px() const { return 0.5 * (size_px.width - 1); }
  double cy_px() const { return 0.5 * (size_px.height - 1); }
};

/// World axes are the target camera's: x right, y down, z forward; the target is at the origin.
struct AnalyticScene {
  double floor_y_m = 1.5, back_z_m = 4.5, half_width_m = 2.5, ceiling_y_m = -1.4;
  bool person = true;
  double person_x_m = 0.1, person_z_m = 2.6;
  bool box = true;   ///< cupboard at the left
  bool pole = true;  ///< upright pole, 24 mm wide, at 3 m
  double pole_x_m = 1.0, pole_z_m = 3.0, pole_radius_m = 0.012;
};

struct Hit {
  double t = 0;  ///< distance in lengths of the direction; 0: nothing was hit
  bool person = false;
  Eigen::Vector3d albedo{0, 0, 0};
};
/// First surface along origin + t direction.
Hit cast(const AnalyticScene& scene, const Eigen::Vector3d& origin,
         const Eigen::Vector3d& direction);

/// Plate of a colour camera (4 samples per pixel, sRGB, a little noise).
Image<Rgb8> render_plate(const AnalyticScene& scene, const Camera& camera, std::uint32_t seed);
/// Exact z per pixel of an ideal camera, and where the person is (255).
void render_truth(const AnalyticScene& scene, const Camera& camera, Image<float>& depth_m,
                  Image<std::uint8_t>& person);
/// Depth picture of a phase-measuring ToF camera, z in metres: 4x4 phasors per pixel at 20 MHz, so
/// that borders have flying pixels, and noise that grows with z^2.
Image<float> render_tof(const AnalyticScene& scene, const Camera& camera, std::uint32_t seed,
                        double noise_at_3m_m);
/// Whether the ToF camera sees the surface at each pixel of the target's ideal view.
Image<std::uint8_t> seen_by_tof(const AnalyticScene& scene, const Camera& target, const Camera& tof,
                                const Image<float>& depth_m);

}  // namespace mixrig::test
