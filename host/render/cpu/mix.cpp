// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/mix.h"

#include <algorithm>
#include <optional>

#include "hal/base/srgb.h"

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

glm::vec3 to_vec(Rgbx16 p) { return glm::vec3(p.r, p.g, p.b); }
glm::vec3 decode(Rgb8 p) {
  const auto& linear = srgb_to_linear();
  return glm::vec3(linear[p.r], linear[p.g], linear[p.b]);
}

// Functions of a row are not inlined: g++ makes slower loops of them in one large function.

/// The real scene where its light is less than 1.
[[gnu::noinline]] void apply_light(const Rgbx16* plate, const std::uint16_t* light, int width,
                                   Rgb8* color) {
  const std::uint8_t* srgb =
      srgb_bytes_of_linear16().data();  // a byte that is stored cannot change it
  const auto dim = [&](std::uint32_t c, std::uint32_t by) {
    const std::uint32_t product = c * by + 32768;  // over 65535, rounded
    return srgb[(product + (product >> 16)) >> 16];
  };
  for (int x = 0; x < width; ++x) {
    const std::uint32_t by = light[x];
    if (by == 65535) continue;
    color[x] = {dim(plate[x].r, by), dim(plate[x].g, by), dim(plate[x].b, by)};
  }
}

/// Depths of the real scene: people as measured, the background as learned where it is; 0 where it
/// is not shown. Writes only the wanted ones.
template <bool kMixed, bool kSegmented>
void real_depths(const float* w, const float* background_m, bool replaced,
                 const std::uint8_t* matte, int width, float* mixed_m, float* segmented_m) {
  for (int x = 0; x < width; ++x) {
    const float measured = w[x] > 0 ? 1 / w[x] : 0;
    const float learned = background_m ? background_m[x] : 0;
    const bool person = matte[x] >= kPersonByte;
    if constexpr (kSegmented) segmented_m[x] = person ? measured : 0;
    if constexpr (kMixed)
      mixed_m[x] = person || !(learned > 0)
                       ? (person || (matte[x] == 0 && !replaced) ? measured : 0)
                       : learned;
  }
}

[[gnu::noinline]] void store_real_depths(const MixInput& input, int y, FrameOutput& output) {
  const float* w = input.view_w.row(y);
  const float* background_m = input.background.depth_m.empty() || input.replaced
                                  ? nullptr
                                  : input.background.depth_m.row(y);
  const bool mixed = output.wanted & kMixedDepth, segmented = output.wanted & kSegmentedDepth;
  float* mixed_m = mixed ? output.mixed_depth_m.row(y) : nullptr;
  float* segmented_m = segmented ? output.segmented_depth_m.row(y) : nullptr;
  const std::uint8_t* matte = output.matte.row(y);
  const int width = output.matte.width();
  if (mixed && segmented)
    real_depths<true, true>(w, background_m, input.replaced, matte, width, mixed_m, segmented_m);
  else if (mixed)
    real_depths<true, false>(w, background_m, input.replaced, matte, width, mixed_m, segmented_m);
  else if (segmented)
    real_depths<false, true>(w, background_m, input.replaced, matte, width, mixed_m, segmented_m);
}

/// What a pixel with virtual coverage is made of.
struct Parts {
  glm::vec3 real, shaded;  ///< plate under the light map; shaded colour, premultiplied
  float coverage, matte;   ///< of the virtual layer, of people
  float virtual_m, person_m, background_m;  ///< z, 0 unknown
  std::optional<glm::vec3> room;            ///< the background's own colour under the light map
};

/// Whether the object lies behind the background. A surface that it touches does not hide it, and
/// a background that is not shown or open hides nothing.
bool is_behind_background(const Parts& p) {
  return p.background_m > 0 && p.virtual_m > p.background_m + kContactSlackM;
}
/// Unknown depth never occludes.
bool is_person_before(const Parts& p) {
  return p.matte > 0 && p.person_m > 0 && p.person_m < p.virtual_m;
}

/// The most that the background can contribute to a pixel: no channel of the person is negative.
float most_background(const glm::vec3& real, const glm::vec3& behind) {
  const glm::vec3 ratio = real / glm::max(behind, 1e-6F);
  return std::min({ratio.r, ratio.g, ratio.b});
}

/// Linear colour of the composite.
glm::vec3 mixed_color(const Parts& p) {
  if (!is_person_before(p)) return p.shaded + (1 - p.coverage) * p.real;
  if (p.matte >= 1) return p.real;
  const glm::vec3 behind = p.room.value_or(p.real);
  const float share = std::min(1 - p.matte, most_background(p.real, behind));
  return p.real + share * (p.shaded - p.coverage * behind);
}

Layer visible_layer(const Parts& p) {
  const float share = is_person_before(p) ? p.coverage * (1 - p.matte) : p.coverage;
  if (share >= 0.5F) return Layer::kVirtual;
  return p.matte >= kPersonMatte ? Layer::kPerson : Layer::kBackground;
}

/// Colour of the background without people, linear of kLinearOne: learned, or that around.
std::optional<glm::vec3> room_color(const MixInput& input, int x, int y, float light) {
  if (!input.background.color.empty()) {
    const Rgbf b = input.background.color.row(y)[x];
    if (b.r < 0) return std::nullopt;
    return glm::min(glm::vec3(b.r, b.g, b.b) * input.gain, 1.0F) * (light * kLinearOne);
  }
  if (!input.key) return std::nullopt;
  const glm::vec3 around = input.key->at(x / kBlockPx, y / kBlockPx).room_color;
  if (around.r < 0) return std::nullopt;
  return around * (light * kLinearOne);
}

float light_at(const MixInput& input, int x, int y) {
  return input.light ? static_cast<float>(input.light->visible.row(y)[x]) / kLinearOne : 1;
}

/// Shaded colour of a covered pixel as the camera shows it.
glm::vec3 virtual_color(const MixInput& input, int x, int y) {
  const glm::vec3 c = to_vec(input.objects->color.row(y)[x]) * input.gain;
  if (input.grain == nullptr) return c;
  const float coverage = static_cast<float>(input.objects->coverage.row(y)[x]) / 255;
  return input.grain->added(c, coverage, x, y);
}

/// Of a pixel with or without virtual coverage.
Parts parts_at(const MixInput& input, const FrameOutput& output, int x, int y, bool covered) {
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
  const float learned_m = input.background.depth_m.empty() ? 0 : input.background.depth_m.row(y)[x];
  p.background_m = learned_m > 0 ? learned_m : (matte > 0 ? 0 : measured_m);
  return p;
}

void store_virtual(const Parts& parts, int x, int y, FrameOutput& output) {
  if (visible_layer(parts) != Layer::kVirtual) return;
  if (output.wanted & kMixedDepth) output.mixed_depth_m.row(y)[x] = parts.virtual_m;
  if (output.wanted & kLayer) output.layer.row(y)[x] = static_cast<std::uint8_t>(Layer::kVirtual);
}

[[gnu::noinline]] void mix_virtual(const MixInput& input, int y, FrameOutput& output) {
  const VirtualLayer& objects = *input.objects;
  for (int x = objects.rect.x0; x < objects.rect.x1; ++x) {
    if (objects.coverage.row(y)[x] == 0) continue;
    const Parts parts = parts_at(input, output, x, y, true);
    if (is_behind_background(parts)) continue;
    if (output.wanted & kColor) output.color.row(y)[x] = encode(mixed_color(parts));
    store_virtual(parts, x, y, output);
  }
}

/// What a pixel of a person holds of the person: its colour times the matte.
glm::vec3 person_alone(const Parts& p) {
  if (p.matte >= 1) return p.real;
  if (!p.room) return p.matte * p.real;
  return p.real - std::min(1 - p.matte, most_background(p.real, *p.room)) * *p.room;
}

/// A pixel that shows the backdrop alone.
void store_backdrop(const MixInput& input, int x, int y, FrameOutput& output) {
  const bool any = !input.backdrop.empty();
  if (output.wanted & kColor) output.color.row(y)[x] = any ? input.backdrop.row(y)[x] : Rgb8{};
  if (output.wanted & kAlpha) output.alpha.row(y)[x] = any ? 255 : 0;
}

/// A pixel that a virtual surface covers completely, without people.
void store_set(const MixInput& input, int x, int y, FrameOutput& output) {
  const Rgbx16 c = input.objects->color.row(y)[x];
  if (output.wanted & kColor)
    output.color.row(y)[x] = input.gain == glm::vec3(1) && input.grain == nullptr
                                 ? encode(c)
                                 : encode(virtual_color(input, x, y));
  if (output.wanted & kAlpha) output.alpha.row(y)[x] = 255;
  if (output.wanted & kMixedDepth) output.mixed_depth_m.row(y)[x] = 1 / input.objects->w.row(y)[x];
  if (output.wanted & kLayer) output.layer.row(y)[x] = static_cast<std::uint8_t>(Layer::kVirtual);
}

/// A pixel of which a person or a border of a virtual surface is a part.
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

/// A row where the real background is replaced.
[[gnu::noinline]] void mix_replaced(const MixInput& input, int y, FrameOutput& output) {
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

void fill_layer(const std::uint8_t* matte, int width, std::uint8_t* layer) {
  for (int x = 0; x < width; ++x)
    layer[x] =
        static_cast<std::uint8_t>(matte[x] >= kPersonByte ? Layer::kPerson : Layer::kBackground);
}

}  // namespace

void mix(Crew& crew, const MixInput& input, FrameOutput& output) {
  constexpr int kGrain = 16;
  const int width = input.plate.width();
  const VirtualLayer* objects = input.objects;
  const bool shows_objects = output.wanted & (kColor | kMixedDepth | kLayer);
  crew.rows(input.plate.height(), kGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      store_real_depths(input, y, output);
      if (output.wanted & kLayer) fill_layer(output.matte.row(y), width, output.layer.row(y));
      if (input.replaced) {
        mix_replaced(input, y, output);
        continue;
      }
      if (input.light && (output.wanted & kColor))
        apply_light(input.plate.row(y), input.light->visible.row(y), width, output.color.row(y));
      if (output.wanted & kAlpha) std::fill_n(output.alpha.row(y), width, 255);
      // Alpha alone needs no key, so that there is no matte.
      if (objects && shows_objects && y >= objects->rect.y0 && y < objects->rect.y1)
        mix_virtual(input, y, output);
    }
  });
}

}  // namespace mixrig::render::cpu
