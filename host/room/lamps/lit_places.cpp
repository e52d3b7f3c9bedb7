// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/lit_places.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hal/base/angles.h"
#include "hal/base/srgb.h"
#include "host/math/geometry/lamp.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector3d;

constexpr int kDarkest = 8, kBrightest = 248;  ///< grey levels that are measured
constexpr double kOnPlane_m = 0.015, kOnPlaneSigmas = 2.5, kSameNormal = 0.94;
constexpr int kLeastOfPlane = 30;
constexpr int kPanelSide = 3;

/// Calls use(point) for the points of a panel as lamps, or for a lamp without direction itself.
template <typename Use>
void each_panel_point(const geometry::Lamp& lamp, const Use& use) {
  if (!lamp.direction) {
    use(lamp);
    return;
  }
  const geometry::PanelAxes axes = geometry::panel_axes(*lamp.direction);
  geometry::Lamp point = lamp;
  for (int i = 0; i < kPanelSide; ++i)
    for (int j = 0; j < kPanelSide; ++j) {
      const double u = (i + 0.5) / kPanelSide - 0.5, v = (j + 0.5) / kPanelSide - 0.5;
      point.position_m =
          lamp.position_m + u * lamp.size_m.x() * axes.u + v * lamp.size_m.y() * axes.v;
      use(point);
    }
}

/// Mean of cos(receiver) [cos(emitter)] / d^2 over the part of a lamp's panel that the room does
/// not hide, 1/m^2.
double seen_irradiance(const RoomSurfaces& room, const geometry::Lamp& lamp,
                       const Vector3d& position_m, const Vector3d& normal) {
  const Vector3d start = position_m + 0.01 * normal;
  double sum = 0;
  int count = 0;
  each_panel_point(lamp, [&](const geometry::Lamp& point) {
    ++count;
    const double light = geometry::irradiance(point, position_m, normal);
    if (light > 0 && room.open(start, point.position_m)) sum += light;
  });
  return sum / count;
}

/// The plane of a surface point: its index, or -1.
int plane_of(const RoomSurfaces& room, const SurfacePoint& point) {
  const geometry::Pose base_from_world = geometry::inverse(room.world_from_base());
  const Vector3d p = base_from_world * point.position_m;
  const Vector3d normal = base_from_world.rotation * point.normal;
  const double gate_m = std::max(kOnPlane_m, kOnPlaneSigmas * point.sigma_m);
  for (std::size_t i = 0; i < room.planes().size(); ++i) {
    const Vector3d& inverse = room.planes()[i].inverse_per_m;
    const double off_m = (inverse.dot(p) - 1) / inverse.norm();
    if (std::abs(off_m) < gate_m && -normal.dot(inverse.normalized()) > kSameNormal)
      return static_cast<int>(i);
  }
  return -1;
}

std::optional<Vector3d> color_at(const model::Panorama& p, int x, int y) {
  const int factor = p.color.width() / p.distance_m.width();
  Vector3d sum = Vector3d::Zero();
  for (int j = 0; j < factor; ++j)
    for (int i = 0; i < factor; ++i) {
      const Rgb8 c = p.color.at(factor * x + i, factor * y + j);
      if (std::max({c.r, c.g, c.b}) > kBrightest || std::min({c.r, c.g, c.b}) < kDarkest) return {};
      const auto& linear = linear_of_srgb_bytes();
      sum += Vector3d(linear[c.r], linear[c.g], linear[c.b]);
    }
  return sum / (factor * factor);
}

}  // namespace

std::vector<LitPlace> lit_places(const RoomSurfaces& room, std::span<const FoundLamp> lamps,
                                 int most) {
  const model::Panorama& p = room.panorama();
  const Size size = p.size();
  // Evenly over the sphere, some of them on planes.
  const double step_rad = std::sqrt(4 * kPi / (2.0 * most));
  std::vector<LitPlace> places;
  const auto lamp_count = static_cast<Eigen::Index>(lamps.size());
  for (double elevation = -kPi / 2 + step_rad; elevation < kPi / 2; elevation += step_rad) {
    const double across = std::cos(elevation);
    const int columns = std::max(1, static_cast<int>(2 * kPi * across / step_rad));
    const int y =
        std::clamp(static_cast<int>((kPi / 2 - elevation) / kPi * size.height), 0, size.height - 1);
    for (int k = 0; k < columns; ++k) {
      const int x = static_cast<int>((k + 0.5) / columns * size.width);
      const auto point = p.views.at(x, y) > 0 ? room.at(x, y) : std::nullopt;
      const int plane = point ? plane_of(room, *point) : -1;
      const auto color = plane >= 0 ? color_at(p, x, y) : std::nullopt;
      if (!color) continue;
      const int part = 4 * (8 * x / size.width) + std::min(3, 4 * y / size.height);
      LitPlace place{plane, part, *color, Eigen::RowVectorXd::Ones(lamp_count + 1)};
      const Vector3d normal =
          -(room.world_from_base().rotation *
            room.planes()[static_cast<std::size_t>(plane)].inverse_per_m.normalized());
      for (Eigen::Index l = 0; l < lamp_count; ++l)
        place.gain[l] =
            seen_irradiance(room, lamps[static_cast<std::size_t>(l)], point->position_m, normal);
      places.push_back(std::move(place));
    }
  }
  return places;
}

int keep_large_planes(std::vector<LitPlace>& places) {
  std::vector<int> count(256), number(256, -1);
  for (const LitPlace& p : places) ++count[static_cast<std::size_t>(p.plane)];
  int planes = 0;
  for (std::size_t i = 0; i < count.size(); ++i)
    if (count[i] >= kLeastOfPlane) number[i] = planes++;
  std::erase_if(places, [&](LitPlace& p) {
    p.plane = number[static_cast<std::size_t>(p.plane)];
    return p.plane < 0;
  });
  return planes;
}

}  // namespace mixrig::lights
