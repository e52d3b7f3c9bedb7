// SPDX-License-Identifier: Apache-2.0
#include "tests/support/analytic_scene.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace mixrig::test {
namespace {

using Eigen::Vector3d;

double hash01(double a, double b) {
  const double s = std::sin(a * 127.1 + b * 311.7) * 43758.5453;
  return s - std::floor(s);
}

/// A checkerboard of squares of `size` metres in two tones with a little grain.
Vector3d checks(double a, double b, double size, const Vector3d& tone) {
  const double i = std::floor(a / size), j = std::floor(b / size);
  return tone * (0.75 + 0.35 * hash01(i, j));
}

void take_nearer(Hit& hit, double t, bool person, const Vector3d& albedo) {
  if (t > 1e-6 && (hit.t == 0 || t < hit.t)) hit = {t, person, albedo};
}

void cast_room(const AnalyticScene& s, const Vector3d& o, const Vector3d& d, Hit& hit) {
  const auto plane = [&](int axis, double at, const Vector3d& tone) {
    if (std::abs(d[axis]) < 1e-12) return;
    const double t = (at - o[axis]) / d[axis];
    const Vector3d p = o + t * d;
    take_nearer(hit, t, false, checks(p[(axis + 1) % 3], p[(axis + 2) % 3], 0.3, tone));
  };
  if (d.y() > 0) plane(1, s.floor_y_m, {0.45, 0.33, 0.22});
  if (d.y() < 0) plane(1, s.ceiling_y_m, {0.7, 0.7, 0.7});
  if (d.x() != 0) plane(0, d.x() > 0 ? s.half_width_m : -s.half_width_m, {0.5, 0.55, 0.6});
  if (d.z() > 0) plane(2, s.back_z_m, {0.6, 0.58, 0.5});
}

void cast_box(const Vector3d& low, const Vector3d& high, const Vector3d& o, const Vector3d& d,
              Hit& hit) {
  double enter = 0, leave = 1e9;
  for (int i = 0; i < 3; ++i) {
    const double a = (low[i] - o[i]) / d[i], b = (high[i] - o[i]) / d[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter < leave) take_nearer(hit, enter, false, {0.2, 0.12, 0.08});
}

void cast_sphere(const Vector3d& center, double radius, const Vector3d& o, const Vector3d& d,
                 const Vector3d& albedo, Hit& hit) {
  const Vector3d q = o - center;
  const double a = d.squaredNorm(), b = q.dot(d), c = q.squaredNorm() - radius * radius;
  const double disc = b * b - a * c;
  if (disc > 0) take_nearer(hit, (-b - std::sqrt(disc)) / a, true, albedo);
}

/// Casts a ray at a capsule: a cylinder between two points with round ends.
void cast_capsule(const Vector3d& p0, const Vector3d& p1, double radius, const Vector3d& o,
                  const Vector3d& d, const Vector3d& albedo, bool person, Hit& hit) {
  const Vector3d axis = p1 - p0, q = o - p0;
  const double aa = axis.squaredNorm(), ad = axis.dot(d), aq = axis.dot(q);
  const double a = d.squaredNorm() - ad * ad / aa, b = q.dot(d) - aq * ad / aa;
  const double c = q.squaredNorm() - aq * aq / aa - radius * radius;
  const double disc = b * b - a * c;
  if (disc > 0 && a > 1e-12) {
    const double t = (-b - std::sqrt(disc)) / a, along = (aq + t * ad) / aa;
    if (along >= 0 && along <= 1) take_nearer(hit, t, person, albedo);
  }
  if (!person) return;
  cast_sphere(p0, radius, o, d, albedo, hit);
  cast_sphere(p1, radius, o, d, albedo, hit);
}

void cast_person(const AnalyticScene& s, const Vector3d& o, const Vector3d& d, Hit& hit) {
  const Vector3d foot(s.person_x_m, s.floor_y_m, s.person_z_m);
  const auto limb = [&](double x0, double up0, double x1, double up1, double radius,
                        const Vector3d& albedo, double forward = 0) {
    cast_capsule(foot + Vector3d(x0, -up0, 0), foot + Vector3d(x1, -up1, -forward), radius, o, d,
                 albedo, true, hit);
  };
  const Vector3d jeans(0.08, 0.12, 0.3), shirt(0.55, 0.12, 0.1), skin(0.62, 0.4, 0.3);
  limb(-0.12, 0.07, -0.10, 0.85, 0.07, jeans);
  limb(0.12, 0.07, 0.10, 0.85, 0.07, jeans);
  limb(0, 0.95, 0, 1.30, 0.16, shirt);
  limb(-0.22, 1.35, -0.45, 1.05, 0.045, shirt);
  limb(0.22, 1.35, 0.40, 1.55, 0.045, skin, 0.2);
  cast_sphere(foot + Vector3d(0, -1.62, 0), 0.11, o, d, skin, hit);
}

Vector3d ray_of(const Camera& camera, double u, double v) {
  const double xd = (u - camera.cx_px()) / camera.f_px, yd = (v - camera.cy_px()) / camera.f_px;
  double scale = 1;  // ideal = distorted / (1 + k1 r2) by fixed point
  for (int i = 0; i < 30 && camera.k1 != 0; ++i)
    scale = 1 / (1 + camera.k1 * scale * scale * (xd * xd + yd * yd));
  return {xd * scale, yd * scale, 1};
}

std::uint8_t to_srgb(double linear) {
  const double c = std::clamp(linear, 0.0, 1.0);
  return static_cast<std::uint8_t>(
      std::lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055)));
}

}  // namespace

Hit cast(const AnalyticScene& s, const Vector3d& o, const Vector3d& d) {
  Hit hit;
  cast_room(s, o, d, hit);
  if (s.box) cast_box({-1.9, 0.3, 3.2}, {-1.1, s.floor_y_m, 3.8}, o, d, hit);
  if (s.pole)
    cast_capsule({s.pole_x_m, s.ceiling_y_m, s.pole_z_m}, {s.pole_x_m, s.floor_y_m, s.pole_z_m},
                 s.pole_radius_m, o, d, {0.3, 0.3, 0.32}, false, hit);
  if (s.person) cast_person(s, o, d, hit);
  return hit;
}

Image<Rgb8> render_plate(const AnalyticScene& scene, const Camera& camera, std::uint32_t seed) {
  Image<Rgb8> plate(camera.size_px);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.004);
  for (int y = 0; y < plate.height(); ++y)
    for (int x = 0; x < plate.width(); ++x) {
      Vector3d sum(0, 0, 0);
      for (int i = 0; i < 4; ++i) {
        const Vector3d d = ray_of(camera, x + 0.25 - 0.5 * (i % 2), y + 0.25 - 0.5 * (i / 2));
        sum += cast(scene, camera.position_m, d).albedo / 4;
      }
      plate.row(y)[x] = {to_srgb(sum.x() + noise(random)), to_srgb(sum.y() + noise(random)),
                         to_srgb(sum.z() + noise(random))};
    }
  return plate;
}

void render_truth(const AnalyticScene& scene, const Camera& camera, Image<float>& depth_m,
                  Image<std::uint8_t>& person) {
  depth_m.reset(camera.size_px);
  person.reset(camera.size_px);
  for (int y = 0; y < depth_m.height(); ++y)
    for (int x = 0; x < depth_m.width(); ++x) {
      const Vector3d ideal((x - camera.cx_px()) / camera.f_px, (y - camera.cy_px()) / camera.f_px,
                           1);
      const Hit hit = cast(scene, camera.position_m, ideal);
      depth_m.row(y)[x] = static_cast<float>(hit.t);
      person.row(y)[x] = hit.person ? 255 : 0;
    }
}

Image<float> render_tof(const AnalyticScene& scene, const Camera& camera, std::uint32_t seed,
                        double noise_at_3m_m) {
  constexpr double kMetresPerRadian = 7.5 / (2 * std::numbers::pi);
  Image<float> depth(camera.size_px);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      std::complex<double> sum = 0;
      for (int i = 0; i < 16; ++i) {
        const Vector3d d = ray_of(camera, x + (i % 4) / 4.0 - 0.375, y + (i / 4) / 4.0 - 0.375);
        const Hit hit = cast(scene, camera.position_m, d);
        const double range = hit.t * d.norm();
        sum += std::polar(hit.albedo.sum() / (range * range), range / kMetresPerRadian);
      }
      const double phase = std::arg(sum);
      const double range = (phase < 0 ? phase + 2 * std::numbers::pi : phase) * kMetresPerRadian;
      const double z = range / ray_of(camera, x, y).norm();
      depth.row(y)[x] = static_cast<float>(z + noise_at_3m_m * z * z / 9 * noise(random));
    }
  return depth;
}

Image<std::uint8_t> seen_by_tof(const AnalyticScene& scene, const Camera& target, const Camera& tof,
                                const Image<float>& depth_m) {
  Image<std::uint8_t> seen(depth_m.size());
  for (int y = 0; y < seen.height(); ++y)
    for (int x = 0; x < seen.width(); ++x) {
      const double z = depth_m.row(y)[x];
      const Vector3d p((x - target.cx_px()) / target.f_px * z,
                       (y - target.cy_px()) / target.f_px * z, z);
      const Vector3d q = p - tof.position_m;
      const double u = tof.f_px * q.x() / q.z() + tof.cx_px(),
                   v = tof.f_px * q.y() / q.z() + tof.cy_px();
      const bool inside = u > 0 && v > 0 && u < tof.size_px.width - 1 && v < tof.size_px.height - 1;
      seen.row(y)[x] = inside && cast(scene, tof.position_m, q).t > 0.995 ? 255 : 0;
    }
  return seen;
}

}  // namespace mixrig::test
