// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/places.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "host/room/scan/panorama/around.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kLeastIncidence = 0.15;  ///< 81 degrees

Eigen::Vector2d pixel_of(Size size, const Vector3d& ray) {
  const double azimuth = std::atan2(-ray.x(), ray.y());
  const double elevation = std::asin(std::clamp(ray.z(), -1.0, 1.0));
  return {(pi - azimuth) * size.width / (2 * pi) - 0.5,
          (pi / 2 - elevation) * size.height / pi - 0.5};
}

Eigen::Vector3f place_color(const Panorama& p, const Eigen::Vector2d& at) {
  if (p.color.empty()) return Eigen::Vector3f::Zero();
  const int factor = p.color.height() / p.size().height, width = p.color.width();
  const int x = (static_cast<int>((at.x() + 0.5) * factor) % width + width) % width;
  const int y = std::clamp(static_cast<int>((at.y() + 0.5) * factor), 0, p.color.height() - 1);
  const Rgb8 c = p.color.row(y)[x];
  return {static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)};
}

/// Normal of a place by its neighbours at `reach` pixels; nullopt across a depth step.
std::optional<Vector3d> place_normal(const Panorama& p, const Directions& rays, int x, int y,
                                     int reach) {
  const Size size = p.size();
  if (y < reach || y + reach >= size.height) return {};
  const int wide =
      std::min(size.width / 8, static_cast<int>(reach / std::max(rays.across(y), 0.05)));
  const std::array<std::array<int, 2>, 4> around{{{(x + size.width - wide) % size.width, y},
                                                  {(x + wide) % size.width, y},
                                                  {x, y - reach},
                                                  {x, y + reach}}};
  std::array<Vector3d, 4> at_m;
  const float here_m = p.distance_m.row(y)[x];
  for (std::size_t i = 0; i < 4; ++i) {
    const auto [u, v] = around[i];
    const float d_m = p.distance_m.row(v)[u];
    if (d_m <= 0 || std::abs(d_m - here_m) > 0.2F * here_m) return {};
    at_m[i] = d_m * rays(u, v);
  }
  const Vector3d here = here_m * rays(x, y);
  // On one surface the middle of opposite neighbours is near the place.
  constexpr double kBent = 0.02;
  Vector3d normal = (at_m[1] - at_m[0]).cross(at_m[2] - at_m[3]).normalized();
  if (!normal.allFinite()) return {};
  for (const Vector3d& m : at_m)
    if (std::abs(normal.dot(m - here)) > kBent * here_m) return {};
  return normal.dot(here) < 0 ? Vector3d(-normal) : normal;
}

}  // namespace

std::vector<RoomPlace> places_of(const Panorama& p, double step_rad) {
  const Size size = p.size();
  const Directions rays(size);
  const int step = std::max(1, static_cast<int>(step_rad * size.height / pi + 0.5));
  const int reach = std::max(1, size.height / 120);
  std::vector<RoomPlace> places;
  for (int y = step / 2; y < size.height; y += step) {
    const int wide = std::max(step, static_cast<int>(step / std::max(rays.across(y), 0.02)));
    for (int x = wide / 2; x < size.width; x += wide) {
      if (p.distance_m.row(y)[x] <= 0 || p.views.row(y)[x] == 0) continue;
      const auto normal = place_normal(p, rays, x, y, reach);
      if (!normal) continue;
      places.push_back({p.distance_m.row(y)[x] * rays(x, y), *normal, p.sigma_m.row(y)[x],
                        place_color(p, {x, y})});
    }
  }
  return places;
}

Seen look(const Panorama& p, const Vector3d& at_m, const Vector3d& normal, double sigma_m,
          double gate_m) {
  Seen seen;
  const double away_m = at_m.norm();
  if (!(away_m > 1e-3)) return seen;
  const Vector3d ray = at_m / away_m;
  seen.incidence = normal.dot(ray);
  if (seen.incidence < kLeastIncidence) return seen;
  const Eigen::Vector2d pixel = pixel_of(p.size(), ray);
  const Around around(p.size(), pixel);
  const auto d = around.of(p.distance_m);
  const auto [low, high] = std::minmax_element(d.begin(), d.end());
  if (*low <= 0 || is_depth_step(*low, *high)) return seen;
  // On a plane the inverse distance is linear in the ray.
  const double there_m = 1 / around.mix(1 / d[0], 1 / d[1], 1 / d[2], 1 / d[3]);
  seen.sigma_m = around.of(p.sigma_m)[around.nearest()];
  seen.off_m = (away_m - there_m) * seen.incidence;
  gate_m = std::max(gate_m, 3 * std::hypot(sigma_m, seen.sigma_m));
  seen.sight = seen.off_m > gate_m    ? RoomSight::kHidden
               : seen.off_m < -gate_m ? RoomSight::kAgainst
                                      : RoomSight::kAgrees;
  if (seen.sight == RoomSight::kAgrees) seen.color = place_color(p, pixel);
  return seen;
}

}  // namespace mixrig::model
