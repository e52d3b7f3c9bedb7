// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/moved.h"

#include <algorithm>
#include <cmath>

#include "hal/base/angles.h"
#include "host/room/scan/panorama/sphere_areas.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

constexpr double kMovedOff_m = 0.05, kLeastMoved_sr = 9 * kDeg * kDeg;
constexpr Size kMovedGrid{180, 90};

double azimuth_of(const Vector3d& ray) { return std::atan2(-ray.x(), ray.y()); }

void find_moved(const Side& side, const geometry::Pose& a_from_b, std::vector<MovedArea>& moved) {
  const geometry::Pose pose = to_other(side, a_from_b);
  Image<std::uint8_t> against(kMovedGrid);
  for (const RoomPlace& place : side.places) {
    const Seen seen = look(*side.panorama, pose * place.at_m, pose.rotation * place.normal,
                           place.sigma_m, kMovedOff_m);
    if (seen.sight != RoomSight::kAgainst) continue;
    const Vector3d ray = place.at_m.normalized();
    const double u = (kPi - azimuth_of(ray)) / (2 * kPi);
    const double v = (kPi / 2 - std::asin(ray.z())) / kPi;
    const int x = static_cast<int>(u * kMovedGrid.width) % kMovedGrid.width;
    const int y = std::clamp(static_cast<int>(v * kMovedGrid.height), 0, kMovedGrid.height - 1);
    against.row(y)[x] = 1;
  }
  const auto areas = areas_of(kMovedGrid, Directions(kMovedGrid), Vector3d::Zero(),
                              [&](int x, int y) { return against.row(y)[x] != 0; });
  for (const SphereArea& area : areas)
    if (area.solid_angle_sr >= kLeastMoved_sr)
      moved.push_back({side.of_b, azimuth_of(area.direction) / kDeg,
                       std::asin(area.direction.z()) / kDeg, area.solid_angle_sr / kDeg / kDeg});
}

}  // namespace

std::vector<MovedArea> moved_areas(const Sides& sides, const geometry::Pose& a_from_b) {
  std::vector<MovedArea> moved;
  for (const Side& side : sides) find_moved(side, a_from_b, moved);
  std::stable_sort(moved.begin(), moved.end(), [](const MovedArea& p, const MovedArea& q) {
    return p.square_deg > q.square_deg;
  });
  return moved;
}

}  // namespace mixrig::model
