// SPDX-License-Identifier: Apache-2.0
// Bounced modulated light against an integral over the other surface, and the imperfections of the
// depth camera against closed forms.
#include "studio/sensors/multipath.h"

#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "studio/rig_of_seed.h"
#include "studio/sensors/tof_camera.h"

namespace mixrig::studio {
namespace {

using std::numbers::pi;
constexpr double kLight_m_s = 299792458.0;

geometry::Pose looking(const Eigen::Vector3d& eye, const Eigen::Vector3d& at) {
  return geometry::look_at(eye, at, Eigen::Vector3d::UnitZ());
}

/// A floor 2 m x 2 m before a wall at x = 0 that is 2 m high: a corner along y.
struct TofCorner {
  TraceDevice device = *TraceDevice::create();
  TraceScene scene{device};
  Materials materials{1, {}, nullptr};
  TofSensor sensor = tof_sensor(RigPreset::kKinect2);
  geometry::Pose world_from_tof = looking({2.2, 0, 1.2}, {0, 0, 0.5});

  TofCorner() {
    Mesh mesh;
    add_quad(mesh, {0, -1, 0}, {2, 0, 0}, {0, 2, 0}, {Kind::kPaint});
    add_quad(mesh, {0, -1, 0}, {0, 2, 0}, {0, 0, 2}, {Kind::kPaint});
    scene.set(mesh);
  }
  LitScene lit() const { return {&scene, nullptr, &materials, &sensor, world_from_tof}; }
};

/// Light at a point of the wall by way of the floor: midpoint rule over the floor.
std::complex<double> from_floor(const TofCorner& corner, const Eigen::Vector3d& p, double hz,
                                double albedo) {
  constexpr int kSteps = 500;
  const Eigen::Vector3d eye = corner.world_from_tof.translation_m;
  const Optics& o = corner.sensor.optics;
  std::complex<double> sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const Eigen::Vector3d q(2 * (i + 0.5) / kSteps, 2 * (j + 0.5) / kSteps - 1, 0);
      const Eigen::Vector3d in_tof = geometry::inverse(corner.world_from_tof) * q;
      if (std::abs(in_tof.x()) > 0.55 * o.size_px.width / o.fx_px * in_tof.z() ||
          std::abs(in_tof.y()) > 0.55 * o.size_px.height / o.fy_px * in_tof.z())
        continue;
      const Eigen::Vector3d from_eye = q - eye, way = p - q;
      const double d = from_eye.norm(), r = way.norm();
      const double at_floor = -from_eye.z() / d / (d * d);
      const double leaves = way.z() / r, arrives = q.x() / r;
      const double area = 4.0 / kSteps / kSteps;
      sum += std::polar(albedo * at_floor * leaves * arrives * area / (pi * r * r),
                        2 * pi * hz / kLight_m_s * (d + r));
    }
  return sum;
}

TEST(Multipath, light_by_way_of_the_floor_is_the_integral_over_it) {
  const TofCorner corner;
  const double albedo = static_cast<double>(
      corner.materials.infrared({Kind::kPaint}, corner.materials.albedo({Kind::kPaint}, {}, {})));
  for (const double z : {0.1, 0.3, 0.8}) {
    const Eigen::Vector3d p(0, 0.2, z);
    const Echo e =
        bounced_echo(corner.lit(), Vec3(1e-3F, 0.2F, static_cast<float>(z)), Vec3::UnitX(), 4096);
    const std::complex<double> fine = from_floor(corner, p, corner.sensor.fine_hz, albedo);
    const std::complex<double> coarse = from_floor(corner, p, corner.sensor.coarse_hz, albedo);
    const double size = std::abs(coarse);
    EXPECT_NEAR(e.fine_cos, fine.real(), 0.04 * size) << z;
    EXPECT_NEAR(e.fine_sin, fine.imag(), 0.04 * size) << z;
    EXPECT_NEAR(e.coarse_cos, coarse.real(), 0.04 * size) << z;
    EXPECT_NEAR(e.coarse_sin, coarse.imag(), 0.04 * size) << z;
    // With as many rays as in a take, up to one and a half rays too many or too few may meet the
    // floor.
    const Echo few =
        bounced_echo(corner.lit(), Vec3(1e-3F, 0.2F, static_cast<float>(z)), Vec3::UnitX(), 64);
    const double ray = albedo / (1.2 * 1.2) / 64;  // the floor is at least 1.2 m from the eye
    EXPECT_NEAR(few.strength, e.strength, 1.5 * ray) << z;
  }
}

// The sum of a direct phasor and a longer one lies between them: a corner is measured too far.
TEST(Multipath, a_corner_is_measured_too_far_and_more_so_the_nearer_to_it) {
  const TofCorner corner;
  const auto error_mm = [&](float z) {
    const Vec3 p(0, 0.1F, z), eye = corner.world_from_tof.translation_m.cast<float>();
    const float d = (eye - p).norm(), cosine = (eye - p).x() / d;
    const Echo direct = echo_of(corner.sensor, d, 0.6F, cosine);
    const Echo bounced = bounced_echo(corner.lit(), p + Vec3(1e-3F, 0, 0), Vec3::UnitX(), 4096);
    const Echo more = seen_from(corner.sensor, bounced, d, 0.6F);
    const double turn = std::arg(
        std::complex<double>(direct.fine_cos + more.fine_cos, direct.fine_sin + more.fine_sin) /
        std::complex<double>(direct.fine_cos, direct.fine_sin));
    return 1000 * turn * kLight_m_s / (4 * pi * corner.sensor.fine_hz);
  };
  EXPECT_GT(error_mm(0.15F), 3);
  EXPECT_GT(error_mm(0.15F), error_mm(1.6F) + 2);
}

TEST(Multipath, there_is_none_without_another_surface) {
  const TofCorner corner;
  const Echo e = bounced_echo(corner.lit(), {1, 0, 3}, Vec3::UnitZ(), 64);
  EXPECT_EQ(e.strength, 0);
}

TEST(TofImperfections, the_second_harmonic_is_not_corrected) {
  TofSensor sensor = tof_sensor(RigPreset::kSr3000);
  sensor.signal_e *= 1e7F, sensor.full_well_e *= 1e7F, sensor.unit_m = 1e-6;
  sensor.wiggle_rad = 0, sensor.second_rad = 0.01F;
  const NormalTable normal;
  const double per_m = 4 * pi * sensor.fine_hz / kLight_m_s;
  for (const float d : {1.3F, 2.1F, 3.7F}) {
    const Echo e = echo_of(sensor, d, 0.5F, 1);
    const TofValue v = read_taps(sensor, {e, e, e, e}, 1, false, normal);
    const double expected = 0.01 * std::sin(8 * per_m * static_cast<double>(d) + 0.3) / per_m;
    EXPECT_NEAR(v.distance_m - d, expected, 3e-4) << d;
    EXPECT_NEAR(depth_error_m(sensor, static_cast<double>(d)), expected, 1e-5);
  }
}

TEST(TofImperfections, offsets_of_pixels_are_fixed_and_scatter_as_stated) {
  TofSensor sensor = tof_sensor(RigPreset::kKinect2);
  const NormalTable normal;
  EXPECT_EQ(pixel_offset_m(sensor, 3, 17, normal), 0) << "off";
  sensor.offset_sigma_m = 0.003F;
  double squares = 0;
  for (std::size_t i = 0; i < 20000; ++i) {
    const double o = static_cast<double>(pixel_offset_m(sensor, 3, i, normal));
    squares += o * o;
  }
  EXPECT_NEAR(std::sqrt(squares / 20000), 0.003, 0.0001);
  EXPECT_EQ(pixel_offset_m(sensor, 3, 17, normal), pixel_offset_m(sensor, 3, 17, normal));
  EXPECT_NE(pixel_offset_m(sensor, 3, 17, normal), pixel_offset_m(sensor, 4, 17, normal));
}

TEST(TofImperfections, warming_up_decays) {
  TofSensor sensor = tof_sensor(RigPreset::kKinect2);
  sensor.warm_up_m = 0.015F, sensor.warm_s = 300;
  const float begin = warm_up_offset_m(sensor, 5, 0), later = warm_up_offset_m(sensor, 5, 300);
  EXPECT_GT(begin, 0.0019F);
  EXPECT_LT(begin, 0.0123F);
  EXPECT_NEAR(later / begin, std::exp(-1.0), 1e-4);
}

/// A wall that faces the camera, half of it near: every pixel gets a share of the mean phasor.
TEST(TofImperfections, stray_light_pulls_all_distances_to_that_of_the_mean_phasor) {
  const TraceDevice device = *TraceDevice::create();
  TraceScene room(device);
  Mesh mesh;
  add_quad(mesh, {-9, 4, -9}, {18, 0, 0}, {0, 0, 18}, {Kind::kPaint});
  add_quad(mesh, {-9, 1.5F, -9}, {9, 0, 0}, {0, 0, 18}, {Kind::kPaint});
  room.set(mesh);
  const Materials materials(1, {}, nullptr);
  const geometry::Pose world_from_tof = looking({0, 0, 0}, {0, 1, 0});
  TofSensor sensor = tof_sensor(RigPreset::kSr3000);
  sensor.optics.distortion = {};
  sensor.signal_e *= 1e4F, sensor.full_well_e *= 1e5F, sensor.unit_m = 1e-6, sensor.wiggle_rad = 0;
  const auto distances = [&](float stray) {
    sensor.stray = stray;
    TofCamera camera(sensor, 1, false);
    Crew crew(2);
    camera.trace_room(room, materials, world_from_tof, crew);
    const std::array<TraceScene, 4> nobody{TraceScene(device), TraceScene(device),
                                           TraceScene(device), TraceScene(device)};
    const Occluder none(device);
    Image<float> distance, amplitude;
    camera.render({nobody, &none, &room, 1, 0}, materials, crew, distance, amplitude);
    return distance;
  };
  const Image<float> clean = distances(0), spoilt = distances(0.05F);
  // The mean phasor again, from the clean distances alone: strength = albedo cos / d^2.
  const double per_m = 4 * pi * sensor.fine_hz / kLight_m_s;
  const double albedo = static_cast<double>(
      materials.infrared({Kind::kPaint}, materials.albedo({Kind::kPaint}, {}, {})));
  const auto phasor = [&](int x, int y) {
    const double d = static_cast<double>(clean.at(x, y));
    const double u = (x - sensor.optics.cx_px) / sensor.optics.fx_px;
    const double v = (y - sensor.optics.cy_px) / sensor.optics.fy_px;
    return std::polar(albedo / std::sqrt(1 + u * u + v * v) / (d * d), per_m * d);
  };
  std::complex<double> mean = 0;
  for (int y = 0; y < 144; ++y)
    for (int x = 0; x < 176; ++x) mean += phasor(x, y) / (176.0 * 144);
  for (const int x : {20, 60, 120, 160}) {
    const std::complex<double> own = phasor(x, 70);
    const double shift = std::arg((own + 0.05 * mean) / own) / per_m;
    EXPECT_NEAR(spoilt.at(x, 70) - clean.at(x, 70), shift, 0.1 * std::abs(shift) + 3e-4) << x;
  }
  EXPECT_LT(spoilt.at(120, 70) + spoilt.at(60, 70) - clean.at(120, 70) - clean.at(60, 70), -0.02F);
}

}  // namespace
}  // namespace mixrig::studio
