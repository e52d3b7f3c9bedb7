// SPDX-License-Identifier: Apache-2.0
#include "host/render/frame/look_filter.h"

#include <cmath>

namespace mixrig::render {
namespace {

std::uint32_t hashed(std::uint32_t v) {  // PCG, O'Neill 2014
  v = v * 747796405U + 2891336453U;
  v = ((v >> ((v >> 28U) + 4U)) ^ v) * 277803737U;
  return (v >> 22U) ^ v;
}

/// Noise of sigma 1, nearly Gaussian: a sum of four bytes.
float normal_noise(std::uint32_t v) {
  const std::uint32_t h = hashed(v);
  const auto sum =
      static_cast<float>((h & 255U) + (h >> 8U & 255U) + (h >> 16U & 255U) + (h >> 24U));
  return (sum - 510.0F) / 147.8F;
}

/// Values of exp(-steep x^2) at whole pixels.
LookTaps gaussian_taps(float steep) {
  LookTaps taps{1, 0, 0};
  float sum = 1;
  for (int i = 1; i <= kBlurReach; ++i) {
    const auto k = static_cast<std::size_t>(i);
    taps[k] = std::exp(-steep * static_cast<float>(i * i));
    sum += 2 * taps[k];
  }
  for (float& tap : taps) tap /= sum;
  return taps;
}

}  // namespace

Image<PackedNormal> make_grain(const Grain& grain) {
  constexpr int kSide = kGrainTexels;
  const float by = grain.spread, middle = 1 - 2 * by;
  // Four independent smoothed fields: one for each channel, and one that the channels share.
  Image<glm::vec4> noise({kSide, kSide}), across({kSide, kSide});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 4; ++c)
        noise.row(y)[x][c] = normal_noise(static_cast<std::uint32_t>((c * kSide + y) * kSide + x));
  const auto wrap = [](int i) { return i & (kSide - 1); };
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      across.row(y)[x] =
          middle * noise.row(y)[x] + by * (noise.row(y)[wrap(x - 1)] + noise.row(y)[wrap(x + 1)]);
  const float sigma = middle * middle + 2 * by * by;
  const float own = std::sqrt(1 - grain.shared), shared = std::sqrt(grain.shared);
  Image<PackedNormal> out({kSide, kSide});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const glm::vec4 n = middle * across.row(y)[x] +
                          by * (across.row(wrap(y - 1))[x] + across.row(wrap(y + 1))[x]);
      const glm::vec3 v = (own * glm::vec3(n) + shared * n.w) / (sigma * kGrainSigmas);
      const glm::vec3 bytes = glm::round(127.0F * glm::clamp(v, -1.0F, 1.0F));
      out.row(y)[x] = {static_cast<std::int8_t>(bytes.x), static_cast<std::int8_t>(bytes.y),
                       static_cast<std::int8_t>(bytes.z), 0};
    }
  return out;
}

glm::ivec2 grain_offset(std::uint32_t frame) {
  const std::uint32_t h = hashed(frame);
  return {static_cast<int>(h & (kGrainTexels - 1)),
          static_cast<int>(h >> 16U & (kGrainTexels - 1))};
}

LookTaps blur_taps(float sigma_px) {
  LookTaps taps{1, 0, 0};
  if (!(sigma_px > 0)) return taps;
  // At whole pixels and cut off, a Gaussian has less variance than between them.
  float flat = 0.01F, steep = 20;
  for (int i = 0; i < 24; ++i) {
    const float middle = std::sqrt(flat * steep);
    taps = gaussian_taps(middle);
    const float variance = 2 * (taps[1] + 4 * taps[2]);
    (variance > sigma_px * sigma_px ? flat : steep) = middle;
  }
  return taps;
}

LookFilter look_filter(const PictureLook& look) {
  const float blur_px2 = look.blur_px * look.blur_px;
  const auto chroma = [&](float more_px) {
    return blur_taps(std::sqrt(blur_px2 + more_px * more_px));
  };
  LookFilter filter{blur_taps(look.blur_px), chroma(look.chroma_px.x), chroma(look.chroma_px.y)};
  // Sharpens after the blur, as far as the taps reach; what would lie beyond is kept in them.
  const float s = look.sharpening;
  const LookTaps b = filter.light;
  filter.light = {(1 + 2 * s) * b[0] - 2 * s * b[1], (1 + 2 * s) * b[1] - s * (b[0] + b[2]),
                  (1 + 2 * s) * b[2] - s * b[1] - s * b[2]};
  return filter;
}

glm::vec4 from_differences(const glm::vec4& d, float most_alpha) {
  const glm::vec3 weights(luminance({1, 0, 0}), luminance({0, 1, 0}), luminance({0, 0, 1}));
  const float green = -(weights.r * d.y + weights.b * d.z) / weights.g;
  const glm::vec3 color = glm::max(d.x + glm::vec3(d.y, green, d.z), 0.0F);
  const float scale = d.w > most_alpha ? most_alpha / d.w : 1;
  return scale * glm::vec4(color, d.w);
}

}  // namespace mixrig::render
