// SPDX-License-Identifier: Apache-2.0
// Pass light: what its files share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/render/cpu/irradiance.h"
#include "host/render/cpu/light.h"

namespace mixrig::render::cpu {

/// Pixels that are tested together for shadows. A register divides the width.
inline constexpr int kLitTileWidth = 16, kLitTileHeight = 8;
inline constexpr std::uint16_t kLit = 65535;

inline std::uint16_t light_to_fixed(float share) {
  return static_cast<std::uint16_t>(kLinearOne * std::clamp(share, 0.0F, 1.0F) + 0.5F);
}

inline glm::vec3 ray_of(const PinholeParams& view, int x, int y) {
  return {(static_cast<float>(x) - view.center_px.x) / view.focal_px.x,
          (static_cast<float>(y) - view.center_px.y) / view.focal_px.y, 1};
}

/// Least and largest positive value of a rectangle; 0, 0 where none is.
std::pair<float, float> positive_range(ImageView<const float> image, const Rect& rect);

/// Lamps that may be hidden from anything that the rectangle's pixels show between two depths.
LampSet lamps_in_doubt(const PinholeParams& view, const std::vector<LampParams>& lamps,
                       const std::vector<ShadowMap>& maps, const Rect& rect, float near_m,
                       float far_m);

}  // namespace mixrig::render::cpu
