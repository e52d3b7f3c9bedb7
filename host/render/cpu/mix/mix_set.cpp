// SPDX-License-Identifier: Apache-2.0
// Pass mix where a set, a picture or nothing replaces the real background.
#include "hal/base/srgb.h"
#include "host/render/cpu/mix/mix_parts.h"

namespace mixrig::render::cpu {
namespace {

Rgb8 encode(const glm::vec3& linear) {
  const auto& srgb = srgb_bytes_of_linear16();
  const glm::vec3 c = glm::clamp(linear, 0.0F, kLinearOne) + 0.5F;
  return {srgb[static_cast<std::size_t>(c.r)], srgb[static_cast<std::size_t>(c.g)],
          srgb[static_cast<std::size_t>(c.b)]};
}

Rgb8 encode(Rgbx16 c) {
  const std::uint8_t* srgb = srgb_bytes_of_linear16().data();
  return {srgb[c.r], srgb[c.g], srgb[c.b]};
}

glm::vec3 decode(Rgb8 p) {
  const auto& linear = srgb_to_linear();
  return glm::vec3(linear[p.r], linear[p.g], linear[p.b]);
}

/// A person's contribution to a pixel: colour times matte.
glm::vec3 person_alone(const Parts& p) {
  if (p.matte >= 1) return p.real;
  if (!p.room) return p.matte * p.real;
  return p.real - std::min(1 - p.matte, most_background(p.real, *p.room)) * *p.room;
}

/// Writes a pixel that shows only the backdrop.
void store_backdrop(const MixInput& input, int x, int y, FrameOutput& output) {
  const bool any = !input.backdrop.empty();
  if (output.wanted & kColor) output.color.row(y)[x] = any ? input.backdrop.row(y)[x] : Rgb8{};
  if (output.wanted & kAlpha) output.alpha.row(y)[x] = any ? 255 : 0;
}

/// Writes a pixel that a virtual surface covers completely, without people.
void store_set(const MixInput& input, int x, int y, FrameOutput& output) {
  const Rgbx16 c = input.objects->color.row(y)[x];
  if (output.wanted & kColor)
    output.color.row(y)[x] =
        !input.tone.bends && input.tone.gain == glm::vec3(1) && input.grain == nullptr
            ? encode(c)
            : encode(virtual_color(input, x, y));
  if (output.wanted & kAlpha) output.alpha.row(y)[x] = 255;
  if (output.wanted & kMixedDepth) output.mixed_depth_m.row(y)[x] = 1 / input.objects->w.row(y)[x];
  if (output.wanted & kLayer) output.layer.row(y)[x] = static_cast<std::uint8_t>(Layer::kVirtual);
}

/// Writes a pixel with a part of a person or of a virtual surface's border.
void mix_over_set(const MixInput& input, int x, int y, bool covered, FrameOutput& output) {
  const Parts p = parts_at(input, output, x, y, covered);
  const bool has_far = !input.backdrop.empty();
  if (output.wanted & kColor) {
    const glm::vec3 far = has_far ? decode(input.backdrop.row(y)[x]) : glm::vec3(0);
    const glm::vec3 behind = p.shaded + (1 - p.coverage) * far;
    const glm::vec3 person = p.matte > 0 ? person_alone(p) : glm::vec3(0);
    output.color.row(y)[x] =
        encode(is_person_before(p) || !covered
                   ? person + (1 - p.matte) * behind
                   : p.shaded + (1 - p.coverage) * (person + (1 - p.matte) * far));
  }
  const float alpha = has_far ? 1 : 1 - (1 - p.matte) * (1 - p.coverage);
  if (output.wanted & kAlpha)
    output.alpha.row(y)[x] = static_cast<std::uint8_t>(255 * alpha + 0.5F);
  if (covered) store_virtual(p, x, y, output);
}

}  // namespace

void mix_replaced(const MixInput& input, int y, FrameOutput& output) {
  const VirtualLayer* objects = input.objects;
  if (objects && (y < objects->rect.y0 || y >= objects->rect.y1)) objects = nullptr;
  const int x0 = objects ? objects->rect.x0 : 0, x1 = objects ? objects->rect.x1 : 0;
  const std::uint8_t* matte = output.matte.row(y);
  for (int x = 0; x < output.matte.width(); ++x) {
    const int coverage = x >= x0 && x < x1 ? objects->coverage.row(y)[x] : 0;
    if (matte[x] > 0 || (coverage > 0 && coverage < 255))
      mix_over_set(input, x, y, coverage > 0, output);
    else if (coverage > 0)
      store_set(input, x, y, output);
    else
      store_backdrop(input, x, y, output);
  }
}

}  // namespace mixrig::render::cpu
