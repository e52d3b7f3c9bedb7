// SPDX-License-Identifier: Apache-2.0
// Noise and width of edges that are found in pictures of known ones.
#include "host/render/frame/look_filter.h"
#include "host/render/frame/picture_look.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::render {
namespace {

constexpr int kSide = 24, kBlocks = 300;

/// Blocks of one shade each, some with a slanting step that is blurred by `sigma_px` and sampled
/// over the area of a pixel.
Image<glm::vec3> picture_of(float floor, float slope, float spread, float sigma_px, bool texture) {
  std::mt19937 random(9);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform;
  Image<glm::vec3> light({kSide, kSide * kBlocks});
  for (int b = 0; b < kBlocks; ++b) {
    const float shade = 0.05F + 0.6F * static_cast<float>(b % 10) / 10;
    const float at = 10 + 4 * uniform(random), tilt = 0.06F * (uniform(random) - 0.5F);
    Image<glm::vec3> white({kSide + 2, kSide + 2});
    for (int y = 0; y < kSide + 2; ++y)
      for (int x = 0; x < kSide + 2; ++x)
        white.at(x, y) = {normal(random), normal(random), normal(random)};
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        float v = shade;
        if (b % 3 == 0) {
          float step = 0;
          for (int k = 0; k < 8; ++k) {
            const float px = static_cast<float>(x) + (static_cast<float>(k) - 3.5F) / 8;
            const float d = px - at - tilt * static_cast<float>(y);
            step += 0.125F * (sigma_px > 0 ? 0.5F * std::erfc(-d / (sigma_px * std::sqrt(2.0F)))
                                           : (d > 0 ? 1.0F : 0.0F));
          }
          v += 0.25F * step;
        } else if (texture && b % 3 == 1) {
          v *= 0.8F + 0.4F * uniform(random);
        }
        glm::vec3 noise(0);
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i)
            noise += (i == 0 ? 1 - 2 * spread : spread) * (j == 0 ? 1 - 2 * spread : spread) *
                     white.at(x + 1 + i, y + 1 + j);
        light.at(x, kSide * b + y) = glm::vec3(v) + std::sqrt(floor + slope * v) * noise;
      }
  }
  return light;
}

/// Blocks with an upright step each, of brightness and of colour, both soft.
Image<glm::vec3> colored_steps(float light_px, float chroma_px) {
  Image<glm::vec3> light({kSide, kSide * 60});
  for (int b = 0; b < 60; ++b)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const float d = static_cast<float>(x) - 11.2F - 0.01F * static_cast<float>(b);
        const auto step = [&](float sigma) {
          return 0.5F * std::erfc(-d / (sigma * std::sqrt(2.0F)));
        };
        const float red = (b % 2 == 0 ? 0.15F : -0.1F) * step(chroma_px);
        const glm::vec4 differences(0.3F + 0.3F * step(light_px), red, -0.5F * red, 1);
        light.at(x, kSide * b + y) = glm::vec3(from_differences(differences, 1));
      }
  return light;
}

/// (-s, 1 + 2 s, -s) along rows, inside of blocks.
Image<glm::vec3> sharpened(const Image<glm::vec3>& from, float s) {
  Image<glm::vec3> to = from;
  for (int y = 0; y < from.height(); ++y)
    for (int x = 1; x + 1 < from.width(); ++x)
      to.row(y)[x] = (1 + 2 * s) * from.at(x, y) - s * (from.at(x - 1, y) + from.at(x + 1, y));
  return to;
}

TEST(PictureLook, FindsHowMuchFartherColourIsBlurred) {
  for (const float chroma : {0.6F, 1.0F, 1.2F}) {
    const PictureLook look = measure_look(colored_steps(0.6F, chroma), {kSide, kSide});
    EXPECT_NEAR(look.chroma_px.x, std::sqrt(chroma * chroma - 0.36F), 0.12F) << chroma;
    EXPECT_EQ(look.chroma_px.y, 0) << "no step lies across columns";
    EXPECT_EQ(look.sharpening, 0);
  }
}

/// Part of the sharpening mask that remains after a blur, by the variance of steps.
TEST(PictureLook, FindsSharpeningThatOutweighsTheBlur) {
  const Image<glm::vec3> soft = picture_of(1e-6F, 1e-5F, 0, 0.5F, false);
  EXPECT_EQ(measure_look(soft, {kSide, kSide}).sharpening, 0);
  for (const float s : {0.3F, 0.4F}) {
    const PictureLook look = measure_look(sharpened(soft, s), {kSide, kSide});
    EXPECT_NEAR(look.sharpening, s - 0.5F * 0.25F, 0.08F);
    EXPECT_EQ(look.blur_px, 0);
  }
}

TEST(PictureLook, FilterKeepsLightAndGrey) {
  const LookFilter filter =
      look_filter({.grain = {}, .blur_px = 0.6F, .chroma_px = {0.9F, 0}, .sharpening = 0.3F});
  for (const LookTaps& taps : {filter.light, filter.chroma_x, filter.chroma_y})
    EXPECT_NEAR(taps[0] + 2 * taps[1] + 2 * taps[2], 1, 1e-6);
  EXPECT_LT(filter.chroma_x[0], filter.chroma_y[0]);
  EXPECT_GT(filter.light[0], filter.chroma_y[0]);
  EXPECT_LT(filter.light[2], 0);
  const glm::vec4 color(0.3F, 0.5F, 0.1F, 0.8F), over(0.3F, 0.5F, 0.1F, 1.6F);
  EXPECT_LT(glm::distance(from_differences(to_differences(color), 1), color), 1e-6F);
  EXPECT_LT(glm::distance(from_differences(to_differences(over), 1), 0.625F * over), 1e-6F);
}

TEST(PictureLook, FindsTheNoiseOverBrightness) {
  for (const bool texture : {false, true}) {
    const Grain grain = measure_look(picture_of(4e-6F, 6e-5F, 0, 0, texture), {kSide, kSide}).grain;
    for (const float light : {0.1F, 0.5F})
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(std::sqrt(grain.floor[c] + grain.slope[c] * light),
                    std::sqrt(4e-6F + 6e-5F * light), 0.12F * std::sqrt(4e-6F + 6e-5F * light))
            << light << " " << texture;
    EXPECT_LT(grain.spread, 0.03F);
    EXPECT_LT(grain.shared, 0.1F);
  }
}

TEST(PictureLook, FindsHowFarNeighboursAreAlike) {
  for (const float spread : {0.1F, 0.2F}) {
    const Grain grain =
        measure_look(picture_of(1e-6F, 4e-5F, spread, 0, false), {kSide, kSide}).grain;
    EXPECT_NEAR(grain.spread, spread, 0.03F);
    const float kept = (1 - 2 * spread) * (1 - 2 * spread) + 2 * spread * spread;
    const float sigma = kept * std::sqrt(1e-6F + 4e-5F * 0.3F);
    EXPECT_NEAR(std::sqrt(grain.floor.y + grain.slope.y * 0.3F), sigma, 0.15F * sigma);
  }
}

TEST(PictureLook, FindsTheBlurOfALens) {
  for (const float sigma : {0.0F, 0.5F, 0.9F})
    EXPECT_NEAR(measure_look(picture_of(1e-6F, 1e-5F, 0, sigma, true), {kSide, kSide}).blur_px,
                sigma, 0.2F)
        << sigma;
}

TEST(PictureLook, OfAPictureWithoutStepsAndNoiseIsNone) {
  const PictureLook look =
      measure_look(Image<glm::vec3>({kSide, 50 * kSide}, glm::vec3(0.4F)), {kSide, kSide});
  EXPECT_EQ(look.blur_px, 0);
  EXPECT_LT(look.grain.floor.x + look.grain.slope.x, 1e-12F);
}

/// Neither steps nor enough blocks: what was known before stays.
TEST(PictureLook, KeepsWhatItCannotMeasure) {
  PictureLook before;
  before.blur_px = 0.7F, before.chroma_px = {0.5F, 0.4F}, before.grain.floor = glm::vec3(3e-5F);
  const PictureLook same =
      measure_look(Image<glm::vec3>({kSide, 2 * kSide}, glm::vec3(0.95F)), {kSide, kSide}, before);
  EXPECT_EQ(same, before);
  const PictureLook blurred =
      measure_look(picture_of(1e-6F, 1e-5F, 0, 0.5F, false), {kSide, kSide}, before);
  EXPECT_NEAR(blurred.blur_px, 0.5F, 0.2F);
  EXPECT_EQ(blurred.chroma_px, before.chroma_px) << "it has no step of colour";
  EXPECT_LT(blurred.grain.floor.y, 1e-5F);
}

TEST(PictureLook, WantedIsWhatTheSceneAsksFor) {
  PictureLook look;
  look.blur_px = 0.7F, look.chroma_px = {0.5F, 0.4F}, look.grain.floor = glm::vec3(3e-5F);
  const PictureLook some = wanted_of(look, {.chroma = true});
  EXPECT_EQ(some.blur_px, 0);
  EXPECT_FALSE(some.grain.any());
  EXPECT_EQ(some.chroma_px, look.chroma_px);
}

TEST(PictureLook, GrainIsAsItIsTold) {
  const Grain wanted{.floor = glm::vec3(1), .spread = 0.15F, .shared = 0.4F};
  const Image<PackedNormal> noise = make_grain(wanted);
  double sum = 0, square = 0, beside = 0, channels = 0;
  for (int y = 0; y < kGrainTexels; ++y)
    for (int x = 0; x < kGrainTexels; ++x) {
      const double scale = kGrainSigmas / 127.0;
      const PackedNormal a = noise.at(x, y), b = noise.at((x + 1) % kGrainTexels, y);
      sum += scale * a.x, square += scale * scale * a.x * a.x;
      beside += scale * scale * a.x * b.x, channels += scale * scale * a.x * a.y;
    }
  const double count = kGrainTexels * kGrainTexels;
  EXPECT_NEAR(sum / count, 0, 0.02);
  EXPECT_NEAR(square / count, 1, 0.03);
  // Taps of 0.15, 0.7, 0.15: neighbours share 2 x 0.15 x 0.7 of 0.535.
  EXPECT_NEAR(beside / count, 0.21 / 0.535, 0.03);
  EXPECT_NEAR(channels / count, 0.4, 0.03);
  EXPECT_NE(grain_offset(1), grain_offset(2));
}

TEST(PictureLook, TapsOfABlurKeepLight) {
  for (const float sigma : {0.0F, 0.4F, 1.0F}) {
    const auto taps = blur_taps(sigma);
    EXPECT_NEAR(taps[0] + 2 * taps[1] + 2 * taps[2], 1, 1e-6);
    EXPECT_GE(taps[0], taps[1]);
  }
}

TEST(PictureLook, TapsOfABlurHaveItsVariance) {
  for (const float sigma : {0.1F, 0.2F, 0.3F, 0.5F, 0.8F, 1.2F}) {
    const auto taps = blur_taps(sigma);
    EXPECT_NEAR(2 * (taps[1] + 4 * taps[2]), sigma * sigma, 0.01F * sigma * sigma) << sigma;
    EXPECT_GE(taps[1], taps[2]) << sigma;
  }
}

}  // namespace
}  // namespace mixrig::render
