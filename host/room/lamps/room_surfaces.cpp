// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/room_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "hal/base/angles.h"
#include "host/room/scan/shape/room_planes.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector3d;

constexpr double kEnd_m = 0.04;       ///< of a line, where surfaces do not hide
constexpr double kThickness_m = 0.6;  ///< what is farther behind a surface passes behind it
constexpr double kStep_m = 0.03;
constexpr int kMostSteps = 400;

}  // namespace

RoomSurfaces::RoomSurfaces(model::Panorama panorama, const geometry::Pose& world_from_base)
    : panorama_(std::move(panorama)),
      world_from_base_(world_from_base),
      base_from_world_(geometry::inverse(world_from_base)),
      planes_(panorama_.planes.empty() ? model::find_planes(panorama_) : panorama_.planes) {}

RoomSurfaces::Pixel RoomSurfaces::pixel_of(const Vector3d& p) const {
  const Size size = panorama_.size();
  const double distance_m = p.norm();
  const double azimuth = std::atan2(p.y(), p.x()) - kPi / 2;  // 0: ahead
  const double elevation =
      distance_m > 0 ? std::asin(std::clamp(p.z() / distance_m, -1.0, 1.0)) : 0;
  const int x = static_cast<int>(std::floor((kPi - azimuth) / (2 * kPi) * size.width));
  const int y = static_cast<int>(std::floor((kPi / 2 - elevation) / kPi * size.height));
  return {((x % size.width) + size.width) % size.width, std::clamp(y, 0, size.height - 1),
          distance_m};
}

std::optional<SurfacePoint> RoomSurfaces::at(int x, int y) const {
  const Size size = panorama_.size();
  const int reach = std::max(1, size.height / 180);
  if (y < reach || y + reach >= size.height) return {};
  const double across = std::cos(kPi * (0.5 - (y + 0.5) / size.height));
  const int wide = std::min(size.width / 8, static_cast<int>(reach / std::max(across, 0.05)) + 1);
  const auto point = [&](int u, int v) -> Vector3d {
    u = ((u % size.width) + size.width) % size.width;
    return panorama_.distance_m.row(v)[u] * model::direction_of(size, u, v);
  };
  const Vector3d here = point(x, y), left = point(x - wide, y), right = point(x + wide, y),
                 up = point(x, y - reach), down = point(x, y + reach);
  for (const Vector3d* p : {&here, &left, &right, &up, &down})
    if (p->isZero()) return {};
  Vector3d normal = (right - left).cross(up - down);
  if (!(normal.norm() > 0)) return {};
  normal.normalize();
  if (normal.dot(here) > 0) normal = -normal;
  return SurfacePoint{world_from_base_ * here, world_from_base_.rotation * normal,
                      panorama_.sigma_m.at(x, y), x, y};
}

std::optional<SurfacePoint> RoomSurfaces::towards(const Vector3d& position_m) const {
  const Pixel px = pixel_of(base_from_world_ * position_m);
  return at(px.x, px.y);
}

std::optional<double> RoomSurfaces::first_hit(const Vector3d& from_m, const Vector3d& to_m,
                                              double skip_m) const {
  const Vector3d a = base_from_world_ * from_m, b = base_from_world_ * to_m;
  const double length_m = (b - a).norm();
  if (!(length_m > 2 * skip_m)) return {};
  const int steps = std::clamp(static_cast<int>(length_m / kStep_m), 2, kMostSteps);
  for (int i = 0; i <= steps; ++i) {
    const double at_m = skip_m + (length_m - 2 * skip_m) * i / steps;
    const Vector3d p = a + at_m / length_m * (b - a);
    const Pixel px = pixel_of(p);
    const double surface_m = panorama_.distance_m.at(px.x, px.y);
    const double behind_m = px.distance_m - surface_m;
    if (surface_m > 0 && behind_m > std::max(0.01, 2.0 * panorama_.sigma_m.at(px.x, px.y)) &&
        behind_m < kThickness_m)
      return at_m;
  }
  return {};
}

bool RoomSurfaces::open(const Vector3d& from_m, const Vector3d& to_m) const {
  return !first_hit(from_m, to_m, kEnd_m);
}

std::optional<SurfacePoint> RoomSurfaces::meet(const Vector3d& from_m, const Vector3d& ray,
                                               double most_m) const {
  const auto along_m = first_hit(from_m, from_m + most_m * ray, 0);
  return along_m ? towards(from_m + *along_m * ray) : std::nullopt;
}

bool RoomSurfaces::behind_plane(const Vector3d& position_m, double margin_m) const {
  constexpr int kDirections = 16;
  constexpr double kOn_m = 0.06, kLeastOn = 0.6;
  constexpr std::array<double, 3> kRings_deg{10, 20, 30};
  const Vector3d p = base_from_world_ * position_m;
  const double distance_m = p.norm();
  if (!(distance_m > 0)) return false;
  const Vector3d ray = p / distance_m;
  const Vector3d side = ray.unitOrthogonal(), other = ray.cross(side);
  return std::any_of(planes_.begin(), planes_.end(), [&](const model::RoomPlane& plane) {
    // Distance of the point from the plane, behind it.
    const double behind_m = (plane.inverse_per_m.dot(p) - 1) / plane.inverse_per_m.norm();
    if (!(behind_m > margin_m)) return false;
    int on = 0;
    for (int k = 0; k < kDirections; ++k) {
      const double turn = 2 * kPi * k / kDirections;
      const Vector3d out = std::cos(turn) * side + std::sin(turn) * other;
      on += std::any_of(kRings_deg.begin(), kRings_deg.end(), [&](double deg) {
        const Vector3d there = std::cos(deg * kDeg) * ray + std::sin(deg * kDeg) * out;
        const double plane_m = plane.distance_m(there);
        const Pixel px = pixel_of(there);
        return plane_m > 0 && std::abs(panorama_.distance_m.at(px.x, px.y) - plane_m) < kOn_m;
      });
    }
    return on >= kLeastOn * kDirections;
  });
}

}  // namespace mixrig::lights
