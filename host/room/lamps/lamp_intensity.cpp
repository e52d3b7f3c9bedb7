// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/lamp_intensity.h"

#include <numeric>

#include "hal/base/srgb.h"

namespace mixrig::lights {
namespace {

using Eigen::Vector3f;

float luminance_of(const Vector3f& color) {
  return Vector3f(kRec709Red, kRec709Green, kRec709Blue).dot(color);
}

/// Share of each lamp in the light of all, by area and radiance; equal where no lamp has an area.
std::vector<float> parts_of_light(std::span<const FoundLamp> lamps,
                                  std::span<const double> radiance) {
  std::vector<double> light;
  for (std::size_t i = 0; i < lamps.size(); ++i)
    light.push_back((radiance.empty() ? 1 : radiance[i]) * lamps[i].size_m.prod());
  const double all = std::accumulate(light.begin(), light.end(), 0.0);
  std::vector<float> parts;
  for (const double part : light)
    parts.push_back(
        static_cast<float>(all > 0 ? part / all : 1 / static_cast<double>(lamps.size())));
  return parts;
}

}  // namespace

std::vector<Vector3f> lamp_intensities(std::span<const FoundLamp> lamps,
                                       const estimation::Estimate<RoomLight>& light,
                                       std::span<const double> radiance) {
  if (light.usable() && radiance.empty()) return light.value.intensity;
  const std::vector<float> parts = parts_of_light(lamps, radiance);
  std::vector<Vector3f> intensities;
  if (!light.usable()) {
    for (const float part : parts)
      intensities.push_back(Vector3f::Constant(kAssumedIntensity * part));
    return intensities;
  }
  float all = 0;
  for (const Vector3f& measured : light.value.intensity) all += luminance_of(measured);
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const Vector3f& measured = light.value.intensity[i];
    const float own = luminance_of(measured);
    const Vector3f color = own > 0 ? Vector3f(measured / own) : Vector3f(Vector3f::Ones());
    intensities.push_back(parts[i] * all * color);
  }
  return intensities;
}

}  // namespace mixrig::lights
