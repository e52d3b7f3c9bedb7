// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>

#include "host/render/cpu/mix/mix_parts.h"
#include "host/render/cpu/simd.h"

namespace mixrig::render::cpu {
namespace {

/// Most pixels of a row that are encoded together.
constexpr int kMostAtOnce = 256;

// Row functions are not inlined: g++ makes slower loops of them in one large function.

/// Multiplies the real scene by its light where that is less than 1.
[[gnu::noinline]] void apply_light(const Rgbx16* plate, const std::uint16_t* light, int width,
                                   Rgb8* color) {
  const auto dim = [](std::uint32_t c, std::uint32_t by) {
    const std::uint32_t product = c * by + 32768;  // divided by 65535 with rounding below
    return static_cast<std::uint16_t>((product + (product >> 16)) >> 16);
  };
  std::array<Rgbx16, kMostAtOnce> dimmed;
  for (int x = 0; x < width; ++x) {
    if (light[x] == 65535) continue;
    int count = 0;
    for (; count < kMostAtOnce && x + count < width && light[x + count] != 65535; ++count) {
      const std::uint32_t by = light[x + count];
      const Rgbx16 p = plate[x + count];
      dimmed[static_cast<std::size_t>(count)] = {dim(p.r, by), dim(p.g, by), dim(p.b, by)};
    }
    encode_row(dimmed.data(), count, color + x);
    x += count - 1;
  }
}

/// Writes the wanted depths of the real scene: people as measured, the background as learned, else
/// as measured; 0 where it is not shown.
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
  const float* background_m =
      input.room_m.empty() || input.replaced ? nullptr : input.room_m.row(y);
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

/// Linear colour of the composite.
glm::vec3 mixed_color(const Parts& p) {
  if (!is_person_before(p)) return p.shaded + (1 - p.coverage) * p.real;
  if (p.matte >= 1) return p.real;
  const glm::vec3 behind = p.room.value_or(p.real);
  const float share = std::min(1 - p.matte, most_background(p.real, behind));
  return p.real + share * (p.shaded - p.coverage * behind);
}

/// 16-bit numbers, rounded, 65535 = 1.
Rgbx16 to_linear16(const glm::vec3& linear) {
  const glm::vec3 c = glm::clamp(linear, 0.0F, kLinearOne) + 0.5F;
  return {static_cast<std::uint16_t>(c.r), static_cast<std::uint16_t>(c.g),
          static_cast<std::uint16_t>(c.b), 0};
}

F4 to_float4(Rgbx16 p) { return __builtin_convertvector(std::bit_cast<U16x4>(p), F4); }

/// virtual_color() as a vector.
F4 virtual_color4(const MixInput& input, int x, int y) {
  if (input.grain != nullptr || input.tone.bends) {
    const glm::vec3 c = virtual_color(input, x, y);
    return F4{c.r, c.g, c.b, 0};
  }
  return to_float4(input.objects->color.row(y)[x]) *
         F4{input.tone.gain.r, input.tone.gain.g, input.tone.gain.b, 0};
}

/// Least coverage byte of kVirtualShare.
constexpr auto kVirtualByte = static_cast<std::uint8_t>(255 * kVirtualShare + 0.5F);

/// mixed_color() for a pixel without people.
void mix_without_people(Rgbx16 plate, float light, F4 shaded, float coverage, Rgbx16& out) {
  const F4 sum = shaded + (1 - coverage) * (to_float4(plate) * light);
  const F4 white = F4{} + kLinearOne;
  const F4 c = (sum < white ? sum : white) + 0.5F;
  out = std::bit_cast<Rgbx16>(__builtin_convertvector(__builtin_convertvector(c, I4), U16x4));
}

/// Mixes pixels x0 .. x1 - 1 of a row, all with virtual coverage; colour with 65535 = 1. Returns
/// how many there are before the first one whose object lies behind the background.
int mix_covered(const MixInput& input, int y, int x0, int x1, FrameOutput& output, Rgbx16* linear) {
  const VirtualLayer& objects = *input.objects;
  const bool layers = output.wanted & (kMixedDepth | kLayer);
  const float* learned_m = input.room_m.empty() ? nullptr : input.room_m.row(y);
  for (int x = x0; x < x1; ++x) {
    Rgbx16& out = linear[x - x0];
    if (output.matte.row(y)[x] > 0 || !learned_m || !(learned_m[x] > 0)) {
      const Parts parts = parts_at(input, output, x, y, true);
      if (is_behind_background(parts)) return x - x0;
      if (output.wanted & kColor) out = to_linear16(mixed_color(parts));
      store_virtual(parts, x, y, output);
      continue;
    }
    const float virtual_m = 1 / objects.w.row(y)[x];
    if (!input.open_walls && virtual_m > learned_m[x] + kContactSlackM) return x - x0;
    const std::uint8_t coverage = objects.coverage.row(y)[x];
    mix_without_people(input.plate.row(y)[x], light_at(input, x, y), virtual_color4(input, x, y),
                       static_cast<float>(coverage) / 255, out);
    if (!layers || coverage < kVirtualByte) continue;
    if (output.wanted & kMixedDepth) output.mixed_depth_m.row(y)[x] = virtual_m;
    if (output.wanted & kLayer) output.layer.row(y)[x] = static_cast<std::uint8_t>(Layer::kVirtual);
  }
  return x1 - x0;
}

[[gnu::noinline]] void mix_virtual(const MixInput& input, int y, FrameOutput& output) {
  const VirtualLayer& objects = *input.objects;
  const std::uint8_t* coverage = objects.coverage.row(y);
  std::array<Rgbx16, kMostAtOnce> linear;
  for (int x = objects.rect.x0; x < objects.rect.x1; ++x) {
    if (coverage[x] == 0) continue;
    int end = x;
    while (end < objects.rect.x1 && end - x < kMostAtOnce && coverage[end] > 0) ++end;
    for (; x < end; ++x) {  // continues after a pixel whose object lies behind the background
      const int count = mix_covered(input, y, x, end, output, linear.data());
      if (output.wanted & kColor) encode_row(linear.data(), count, output.color.row(y) + x);
      x += count;
    }
    x = end - 1;  // the pixel that ended the run may begin another one
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
      // Alpha alone needs no key, so there may be no matte.
      if (objects && shows_objects && y >= objects->rect.y0 && y < objects->rect.y1)
        mix_virtual(input, y, output);
    }
  });
}

}  // namespace mixrig::render::cpu
