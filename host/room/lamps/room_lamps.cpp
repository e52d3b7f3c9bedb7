// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/room_lamps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "hal/base/angles.h"
#include "hal/base/half.h"
#include "hal/base/srgb.h"

namespace mixrig::lights {
namespace {

constexpr double kPeak_sr = 2e-4;

float luminance_of(const RgbHalf& c) {
  return kRec709Red * float_of_half(c.r) + kRec709Green * float_of_half(c.g) +
         kRec709Blue * float_of_half(c.b);
}

/// Least luminance in the brightest part of the room that covers kPeak_sr.
float peak_of(const Image<RgbHalf>& light) {
  const double step_rad = kPi / light.height();
  std::vector<std::pair<float, double>> bright;
  for (int y = 0; y < light.height(); ++y) {
    const double pixel_sr = step_rad * step_rad * std::cos(kPi / 2 - step_rad * (y + 0.5));
    for (int x = 0; x < light.width(); ++x)
      if (const float l = luminance_of(light.row(y)[x]); l > 1) bright.emplace_back(l, pixel_sr);
  }
  std::sort(bright.begin(), bright.end(), std::greater());
  double sum_sr = 0;
  for (const auto& [l, sr] : bright)
    if ((sum_sr += sr) >= kPeak_sr) return l;
  return 1;
}

/// The light over `white` as bytes.
Image<Rgb8> exposed_for(float white, const Image<RgbHalf>& light) {
  const auto& srgb = srgb_bytes_of_linear16();
  const auto byte = [&](std::uint16_t half) {
    const float share = std::min(float_of_half(half) / white, 1.0F);
    return srgb[static_cast<std::size_t>(65535 * share + 0.5F)];
  };
  Image<Rgb8> picture(light.size());
  for (int y = 0; y < light.height(); ++y)
    for (int x = 0; x < light.width(); ++x) {
      const RgbHalf& c = light.row(y)[x];
      picture.row(y)[x] = {byte(c.r), byte(c.g), byte(c.b)};
    }
  return picture;
}

}  // namespace

LampView view_of_room(const RoomSurfaces& room, const RegionOptions& options) {
  const model::Panorama& panorama = room.panorama();
  Image<Rgb8> exposed;
  if (!panorama.light.empty()) {
    const float peak = peak_of(panorama.light);
    exposed = exposed_for(std::max({1.0F, std::min(1.5F, peak / 2), peak / 4}), panorama.light);
  }
  const Image<Rgb8>& color = exposed.empty() ? panorama.color : exposed;
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
