// SPDX-License-Identifier: Apache-2.0
// The studio's own sRGB curve (IEC 61966-2-1) and texture lookup.
#pragma once

#include <array>
#include <cstdint>

#include "hal/base/image.h"
#include "studio/stage/mesh.h"

namespace mixrig::studio {

/// Linear light of an sRGB byte, 0..1.
float linear_from_srgb(std::uint8_t value);
/// sRGB byte of linear light, clamped to 0..1.
std::uint8_t srgb_from_linear(float value);
inline Rgb8 srgb_from_linear(const Vec3& c) {
  return {srgb_from_linear(c.x()), srgb_from_linear(c.y()), srgb_from_linear(c.z())};
}
/// Linear colour at uv, interpolated bilinearly in linear light; the texture repeats, v grows
/// downwards.
Vec3 sample_texture(ImageView<const Rgb8> texture, const Vec2& uv);

}  // namespace mixrig::studio
