// SPDX-License-Identifier: Apache-2.0
// Pass light: helpers shared by its files.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/render/cpu/light/irradiance.h"
#include "host/render/cpu/light/light.h"

namespace mixrig::render::cpu {

/// Size of a tile, whose pixels are tested together for shadows. A register divides the width.
inline constexpr int kLitTileWidth = 32, kLitTileHeight = 16;
inline constexpr std::uint16_t kLit = 65535;

inline std::uint16_t light_to_fixed(float share) {
  return static_cast<std::uint16_t>(kLinearOne * std::clamp(share, 0.0F, 1.0F) + 0.5F);
}

inline glm::vec3 ray_of(const PinholeParams& view, int x, int y) {
  return {(static_cast<float>(x) - view.center_px.x) / view.focal_px.x,
          (static_cast<float>(y) - view.center_px.y) / view.focal_px.y, 1};
}

inline glm::vec3 unpack(PackedNormal n, const glm::vec3& ray) {
  const glm::vec3 normal(n.x, n.y, n.z);
  return normal == glm::vec3(0) ? -glm::normalize(ray) : glm::normalize(normal);
}
inline VectorLanes unpack(IntLanes packed, const VectorLanes& ray) {
  static_assert(sizeof(PackedNormal) == sizeof(std::int32_t));
  const auto byte = [&](int shift) { return to_float((packed << (24 - shift)) >> 24); };
  const IntLanes none = (packed & 0xFFFFFF) == 0;
  const auto of = [&](FloatLanes n, FloatLanes r) { return none ? -r : n; };
  const VectorLanes n{of(byte(0), ray.x), of(byte(8), ray.y), of(byte(16), ray.z)};
  const FloatLanes scale = 1 / sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  return {n.x * scale, n.y * scale, n.z * scale};
}

/// Whether none of sizeof(Word) pixels shows a person.
template <typename Word>
bool no_people(const std::uint8_t* matte) {
  static_assert(kPersonByte == 128);
  constexpr Word kHighBits = static_cast<Word>(~Word{}) / 255 * 128;
  return (load<Word>(matte) & kHighBits) == 0;
}

/// Writes normals of the background in row y: every `step`-th pixel from x0 on.
void background_normals(const LightInput& input, int x0, int y, std::span<PackedNormal> out,
                        int step);

/// Least and largest positive value in a rectangle; (0, 0) if there is none.
std::pair<float, float> positive_range(ImageView<const float> image, const Rect& rect);

/// Corners of the space that a rectangle of pixels sees between two depths.
Corners corners_of(const PinholeParams& view, const Rect& rect, float near_m, float far_m);

/// Whether the layer keeps its shading without people.
inline bool keeps_alone(const VirtualLayer& layer) { return !layer.alone.in_shadow.empty(); }
/// Allocates that memory for the layer's rectangle, with no shadows of people yet.
void begin_alone(VirtualLayer& layer);

/// What objects may hide from a tile.
struct Doubt {
  LampSet lamps = kAllLamps;
  bool near = true;  ///< ambient light too
};

/// Lamps that objects may hide from anything that the rectangle's pixels see between two depths.
/// `among`: the lamps in doubt for a larger rectangle.
LampSet lamps_in_doubt(const PinholeParams& view, const std::vector<LampParams>& lamps,
                       const std::vector<ShadowMap>& maps, const Rect& rect, float near_m,
                       float far_m, LampSet among = kAllLamps);

}  // namespace mixrig::render::cpu
