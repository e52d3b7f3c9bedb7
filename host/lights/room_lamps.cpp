// SPDX-License-Identifier: Apache-2.0
#include "host/lights/room_lamps.h"

#include <cmath>

#include "hal/base/angles.h"

namespace mixrig::lights {

LampView view_of_room(const RoomSurfaces& room, const RegionOptions& options) {
  const Image<Rgb8>& color = room.panorama().color;
  const auto ray = [&](const Eigen::Vector2d& px) -> std::optional<Eigen::Vector3d> {
    if (px.y() < -0.5 || px.y() > color.height() - 0.5) return {};
    const double azimuth = kPi - 2 * kPi * (px.x() + 0.5) / color.width();
    const double elevation = kPi / 2 - kPi * (px.y() + 0.5) / color.height();
    const double across = std::cos(elevation);
    return Eigen::Vector3d(-across * std::sin(azimuth), across * std::cos(azimuth),
                           std::sin(elevation));
  };
  RegionOptions around = options;
  around.goes_around = true;
  return {room.world_from_base(), find_bright_regions(color, ray, around)};
}

}  // namespace mixrig::lights
