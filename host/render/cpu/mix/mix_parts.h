// SPDX-License-Identifier: Apache-2.0
// Pass mix: composition of a pixel in which layers meet.
#pragma once

#include <algorithm>
#include <optional>

#include "host/render/cpu/mix/mix.h"

namespace mixrig::render::cpu {

inline glm::vec3 to_vec(Rgbx16 p) { return glm::vec3(p.r, p.g, p.b); }

/// Layers of a pixel.
struct Parts {
  glm::vec3 real, shaded;  ///< plate under the light map; shaded virtual colour, premultiplied
  float coverage, matte;   ///< of the virtual layer; of people
  float virtual_m, person_m, background_m;  ///< z, 0 unknown
  std::optional<glm::vec3> room;  ///< the background's own colour under the light map, if known
};

/// Whether the object lies behind the background, by more than kContactSlackM. A background that is
/// open or not shown has depth 0 and hides nothing.
inline bool is_behind_background(const Parts& p) {
  return p.background_m > 0 && p.virtual_m > p.background_m + kContactSlackM;
}
/// Whether the person occludes the object. Unknown depth never occludes.
inline bool is_person_before(const Parts& p) {
  return p.matte > 0 && p.person_m > 0 && p.person_m < p.virtual_m;
}

/// Largest share of the background in a pixel: beyond it, a channel of the person would be
/// negative.
inline float most_background(const glm::vec3& real, const glm::vec3& behind) {
  const glm::vec3 ratio = real / glm::max(behind, 1e-6F);
  return std::min({ratio.r, ratio.g, ratio.b});
}

inline Layer visible_layer(const Parts& p) {
  const bool person = p.matte >= kPersonMatte;
  if (p.coverage >= kVirtualShare && !(person && is_person_before(p))) return Layer::kVirtual;
  return person ? Layer::kPerson : Layer::kBackground;
}

/// Colour of the background without people, linear, scaled by kLinearOne: learned, else the mean of
/// the blocks around.
inline std::optional<glm::vec3> room_color(const MixInput& input, int x, int y, float light) {
  if (!input.background.color.empty()) {
    const Rgbf b = input.background.color.row(y)[x];
    if (b.r < 0) return std::nullopt;
    return glm::min(input.tone(glm::vec3(b.r, b.g, b.b)), 1.0F) * (light * kLinearOne);
  }
  if (!input.key) return std::nullopt;
  const glm::vec3 around = input.key->at(x / kBlockPx, y / kBlockPx).room_color;
  if (around.r < 0) return std::nullopt;
  return around * (light * kLinearOne);
}

inline float light_at(const MixInput& input, int x, int y) {
  return input.light ? static_cast<float>(input.light->visible.row(y)[x]) / kLinearOne : 1;
}

/// Shaded colour of a covered pixel as the camera shows it, with grain.
inline glm::vec3 virtual_color(const MixInput& input, int x, int y) {
  const glm::vec3 shaded = to_vec(input.objects->color.row(y)[x]);
  const float coverage = static_cast<float>(input.objects->coverage.row(y)[x]) / 255;
  const float one = coverage * kLinearOne;  // the colour is premultiplied
  const glm::vec3 c = input.tone.bends ? input.tone(shaded / one) * one : shaded * input.tone.gain;
  if (input.grain == nullptr) return c;
  return input.grain->added(c, coverage, x, y);
}

/// Layers of a pixel; `covered`: the virtual layer covers it.
inline Parts parts_at(const MixInput& input, const FrameOutput& output, int x, int y,
                      bool covered) {
  const float light = light_at(input, x, y);
  const float measured_w = input.view_w.row(y)[x];
  const float measured_m = measured_w > 0 ? 1 / measured_w : 0;
  const std::uint8_t matte = output.matte.row(y)[x];
  Parts p{};
  p.real = to_vec(input.plate.row(y)[x]) * light;
  p.matte = static_cast<float>(matte) / 255;
  p.person_m = matte > 0 ? measured_m : 0;
  if (matte > 0 && matte < 255) p.room = room_color(input, x, y, light);
  if (covered) {
    p.shaded = virtual_color(input, x, y);
    p.coverage = static_cast<float>(input.objects->coverage.row(y)[x]) / 255;
    p.virtual_m = 1 / input.objects->w.row(y)[x];
  }
  if (input.open_walls || input.replaced) return p;
  const float learned_m = input.room_m.empty() ? 0 : input.room_m.row(y)[x];
  p.background_m = learned_m > 0 ? learned_m : (matte > 0 ? 0 : measured_m);
  return p;
}

inline void store_virtual(const Parts& parts, int x, int y, FrameOutput& output) {
  if (visible_layer(parts) != Layer::kVirtual) return;
  if (output.wanted & kMixedDepth) output.mixed_depth_m.row(y)[x] = parts.virtual_m;
  if (output.wanted & kLayer) output.layer.row(y)[x] = static_cast<std::uint8_t>(Layer::kVirtual);
}

/// Mixes a row where the real background is replaced.
void mix_replaced(const MixInput& input, int y, FrameOutput& output);

}  // namespace mixrig::render::cpu
