// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/floating_areas.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"
#include "host/room/scan/panorama/sphere_areas.h"

namespace mixrig::model {
namespace {

constexpr double kLeastFloating_sr = 9 * kDeg * kDeg;
constexpr double kBefore_m = 0.15, kNearPlane_m = 0.04, kLeastOnPlane = 0.7;
constexpr float kJoined_m = 0.3F;  ///< wrapped depth scatters by a tenth of it
constexpr double kWrappedNoise = 6;
constexpr int kMixed_px = 2;  ///< width of a border, whose pixels have parts of both

/// Distance behind the plane; not finite where the plane or the surface is not known.
double behind_m(const Panorama& p, const Directions& directions, const RoomPlane& plane, int x,
                int y) {
  const double there_m = plane.distance_m(directions(x, y)), here_m = p.distance_m.row(y)[x];
  return there_m > 0 && here_m > 0 ? here_m - there_m : std::nan("");
}

/// Sigma over the square of the distance, which light falls with.
float noise_at(const Panorama& p, int x, int y) {
  const float distance_m = p.distance_m.row(y)[x];
  return p.sigma_m.row(y)[x] / (distance_m * distance_m);
}

/// noise_at() of the plane near a pixel of a border; 0 where the plane is not near.
template <typename OffPlane>
float noise_of_plane_at(const Panorama& p, const std::array<int, 2>& border,
                        const OffPlane& off_m) {
  const Size size = p.size();
  for (int dy = -kMixed_px; dy <= kMixed_px; ++dy)
    for (int dx = -kMixed_px; dx <= kMixed_px; ++dx) {
      const int x = (border[0] + dx + size.width) % size.width, y = border[1] + dy;
      if (y >= 0 && y < size.height && std::abs(off_m(x, y)) < kNearPlane_m)
        return noise_at(p, x, y);
    }
  return 0;
}

/// Median noise_at() of the plane around an area; nullopt where less than kLeastOnPlane of the
/// border lies on it.
template <typename OffPlane>
std::optional<float> noise_of_plane_around(const Panorama& p, const SphereArea& area,
                                           const OffPlane& off_m) {
  std::vector<float> of_plane;
  for (const auto& px : area.border)
    if (const float noise = noise_of_plane_at(p, px, off_m); noise > 0) of_plane.push_back(noise);
  if (static_cast<double>(of_plane.size()) <
      kLeastOnPlane * static_cast<double>(area.border.size()))
    return std::nullopt;
  return upper_median_in_place(std::span(of_plane));
}

}  // namespace

std::vector<FloatingArea> floating_areas(const Panorama& p, std::span<const RoomPlane> planes) {
  const Directions directions(p.size());
  std::vector<FloatingArea> floating;
  for (const RoomPlane& plane : planes) {
    const auto off_m = [&](int x, int y) { return behind_m(p, directions, plane, x, y); };
    const auto is_before = [&](int x, int y) { return off_m(x, y) < -kBefore_m; };
    const auto is_joined = [&](int x, int y, int u, int v) {
      return std::abs(p.distance_m.row(y)[x] - p.distance_m.row(v)[u]) < kJoined_m;
    };
    for (SphereArea& area :
         areas_of(p.size(), directions, Eigen::Vector3d::Zero(), is_before, is_joined)) {
      if (area.solid_angle_sr < kLeastFloating_sr) continue;
      const std::optional<float> of_plane = noise_of_plane_around(p, area, off_m);
      if (!of_plane) continue;
      std::vector<float> own;
      for (const auto& [x, y] : area.pixels) own.push_back(noise_at(p, x, y));
      const double noise = upper_median_in_place(std::span(own)) / *of_plane;
      floating.push_back({area.direction, area.solid_angle_sr, noise, std::move(area.pixels)});
    }
  }
  return floating;
}

void forget_wrapped(Panorama& p) {
  for (const FloatingArea& area : floating_areas(p, p.planes)) {
    if (area.noise < kWrappedNoise) continue;
    p.wrapped.push_back({area.direction, area.solid_angle_sr});
    for (const auto& [x, y] : area.pixels)
      p.distance_m.row(y)[x] = p.sigma_m.row(y)[x] = 0, p.views.row(y)[x] = 0;
  }
}

void fill_flat_holes(Panorama& p) {
  const Directions directions(p.size());
  for (const RoomPlane& plane : p.planes) {
    const auto off_m = [&](int x, int y) { return behind_m(p, directions, plane, x, y); };
    const auto is_hole = [&](int x, int y) {
      return p.views.row(y)[x] == 0 && p.field.row(y)[x] != 0;
    };
    for (const SphereArea& hole :
         areas_of(p.size(), directions, Eigen::Vector3d::Zero(), is_hole)) {
      const std::optional<float> noise = noise_of_plane_around(p, hole, off_m);
      if (!noise) continue;
      if (std::any_of(hole.pixels.begin(), hole.pixels.end(),
                      [&](const auto& px) { return p.distance_m.row(px[1])[px[0]] <= 0; }))
        p.flat_holes.push_back({hole.direction, hole.solid_angle_sr});
      for (const auto& [x, y] : hole.pixels) {
        const auto distance_m = static_cast<float>(plane.distance_m(directions(x, y)));
        p.distance_m.row(y)[x] = distance_m;
        p.sigma_m.row(y)[x] = *noise * distance_m * distance_m;
      }
    }
  }
}

}  // namespace mixrig::model
