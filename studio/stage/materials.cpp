// SPDX-License-Identifier: Apache-2.0
// Procedural textures.
#include "studio/stage/materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "studio/sensors/noise.h"
#include "studio/srgb.h"

namespace mixrig::studio {
namespace {

float smooth(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3 - 2 * t);
}
Vec3 mix(const Vec3& a, const Vec3& b, float t) { return a + t * (b - a); }
float fraction(float x) { return x - std::floor(x); }

/// A random colour, pale to saturated, with values from `low` to `high`.
Vec3 hash_color(std::uint64_t key, float low, float high) {
  const float hue = 6 * uniform(hash_key(key, 1)), depth = 0.25F + 0.6F * uniform(hash_key(key, 2));
  const float value = low + (high - low) * uniform(hash_key(key, 3));
  Vec3 color;
  for (int i = 0; i < 3; ++i) {
    const float d = std::abs(std::fmod(hue + 2.0F * static_cast<float>(i), 6.0F) - 3) - 1;
    color[i] = value * (1 - depth + depth * std::clamp(d, 0.0F, 1.0F));
  }
  return color;
}

Vec3 planks(const Vec2& uv, std::uint64_t seed) {
  constexpr float kWidth = 0.14F, kLength = 1.25F;
  const float row = std::floor(uv.y() / kWidth);
  const float along =
      uv.x() / kLength + uniform(hash_key(seed, static_cast<std::uint64_t>(row) + 9));
  const float plank = std::floor(along);
  const std::uint64_t id = hash_key(seed, static_cast<std::uint64_t>(row),
                                    static_cast<std::uint64_t>(static_cast<std::int64_t>(plank)));
  const float tone = 0.75F + 0.4F * uniform(id);
  const Vec2 grain_at(uv.x() * 6 + 50 * uniform(id + 1), uv.y() * 130);
  const float grain = 0.8F + 0.4F * fractal_noise(grain_at, 3, seed);
  const float cross = std::min(fraction(uv.y() / kWidth), 1 - fraction(uv.y() / kWidth)) * kWidth;
  const float end = std::min(fraction(along), 1 - fraction(along)) * kLength;
  const float gap = 0.45F + 0.55F * smooth(0.0005F, 0.0035F, std::min(cross, end));
  return tone * grain * gap * Vec3(0.36F, 0.215F, 0.115F);
}

Vec3 wallpaper(const Vec2& uv, int wall, std::uint64_t seed) {
  static const std::array<Vec3, 4> kPaper{Vec3(0.62F, 0.60F, 0.54F), Vec3(0.50F, 0.56F, 0.58F),
                                          Vec3(0.62F, 0.60F, 0.54F), Vec3(0.60F, 0.52F, 0.44F)};
  const float stripe = smooth(0.42F, 0.46F, std::abs(fraction(uv.x() / 0.24F) - 0.5F));
  const Vec2 cell(
      fraction(uv.x() / 0.24F) - 0.5F,
      fraction(uv.y() / 0.30F + 0.5F * std::fmod(std::floor(uv.x() / 0.24F), 2.0F)) - 0.5F);
  const float petal = cell.norm() * (1.6F + 0.7F * std::cos(5 * std::atan2(cell.y(), cell.x())));
  const float flower = smooth(0.33F, 0.29F, petal);
  const float paper = 0.95F + 0.1F * fractal_noise(uv * 40, 3, seed + 5);
  const float stain = 0.94F + 0.1F * fractal_noise(uv * 1.5F, 3, seed + 6);
  return paper * stain * (1 - 0.10F * stripe - 0.14F * flower) *
         kPaper[static_cast<std::size_t>(wall) % 4];
}

/// A picture of about 0.7 x 0.9 m, chosen by variant: hills, sun, letters.
Vec3 poster(const Vec2& uv, int variant, std::uint64_t seed) {
  const std::uint64_t id = hash_key(seed, static_cast<std::uint64_t>(variant), 77);
  const Vec3 sky = hash_color(id, 0.35F, 0.8F), land = hash_color(id + 1, 0.05F, 0.4F);
  Vec3 color = mix(sky, Vec3(0.8F, 0.75F, 0.6F), std::clamp(1.1F - uv.y(), 0.0F, 1.0F) * 0.5F);
  const Vec2 sun(0.2F + 0.3F * uniform(id + 2), 0.6F);
  if ((uv - sun).norm() < 0.09F) color = Vec3(0.85F, 0.55F, 0.12F);
  for (int hill = 0; hill < 3; ++hill) {
    const float ridge =
        0.45F - 0.11F * static_cast<float>(hill) +
        0.2F * (fractal_noise({uv.x() * 5, 3.0F * static_cast<float>(hill)}, 4, id) - 0.5F);
    if (uv.y() < ridge) color = land * (0.5F + 0.35F * static_cast<float>(hill));
  }
  const float line = uv.y() / 0.035F;
  const bool text = uv.y() < 0.16F && uv.y() > 0.05F && fraction(line) < 0.55F && uv.x() > 0.06F &&
                    uniform(hash_key(id, static_cast<std::uint64_t>(uv.x() / 0.018F),
                                     static_cast<std::uint64_t>(line))) < 0.72F;
  return text ? Vec3(0.82F, 0.82F, 0.78F) : color;
}

Vec3 wood(const Vec2& uv, const Vec3& base, std::uint64_t seed) {
  const float rings = fractal_noise({uv.x() * 4, uv.y() * 45}, 4, seed);
  return base * (0.75F + 0.5F * rings);
}

Vec3 rug(const Vec2& uv) {
  const float border = std::min(fraction(uv.x() / 0.3F), 1 - fraction(uv.x() / 0.3F));
  const float diamond =
      std::abs(fraction(uv.x() / 0.3F) - 0.5F) + std::abs(fraction(uv.y() / 0.3F) - 0.5F);
  const Vec3 red(0.34F, 0.08F, 0.06F), blue(0.07F, 0.10F, 0.20F), cream(0.55F, 0.48F, 0.36F);
  const Vec3 color = diamond < 0.22F ? cream : diamond < 0.38F ? blue : red;
  return border < 0.03F ? mix(color, cream, 0.4F) : color;
}

}  // namespace

Wardrobe choose_wardrobe(unsigned seed, bool dark) {
  static const std::array<Vec3, 5> kSkin{Vec3(0.58F, 0.36F, 0.26F), Vec3(0.48F, 0.27F, 0.17F),
                                         Vec3(0.33F, 0.17F, 0.10F), Vec3(0.18F, 0.09F, 0.055F),
                                         Vec3(0.64F, 0.43F, 0.33F)};
  static const std::array<Vec3, 5> kHair{Vec3(0.02F, 0.016F, 0.013F), Vec3(0.07F, 0.035F, 0.018F),
                                         Vec3(0.16F, 0.085F, 0.04F), Vec3(0.36F, 0.24F, 0.12F),
                                         Vec3(0.26F, 0.25F, 0.24F)};
  static const std::array<Vec3, 5> kTrousers{Vec3(0.055F, 0.085F, 0.17F), Vec3(0.13F, 0.19F, 0.30F),
                                             Vec3(0.035F, 0.035F, 0.04F), Vec3(0.36F, 0.28F, 0.18F),
                                             Vec3(0.20F, 0.20F, 0.19F)};
  const std::uint64_t key = hash_key(seed, 0xC107E5);
  const auto pick = [key](const std::array<Vec3, 5>& from, std::uint64_t salt) {
    return from[static_cast<std::size_t>(hash_key(key, salt) % 5)];
  };
  Wardrobe w;
  w.skin = pick(kSkin, 1), w.hair = pick(kHair, 2), w.trousers = pick(kTrousers, 3);
  w.shirt = hash_color(hash_key(key, 4), 0.08F, 0.75F);
  // One shirt in five is close to the colour of the wallpaper, which is hard to key.
  if (hash_key(key, 5) % 5 == 0) w.shirt = Vec3(0.60F, 0.57F, 0.50F);
  w.shirt_second = hash_color(hash_key(key, 6), 0.05F, 0.8F);
  w.shoes = uniform(hash_key(key, 7)) < 0.5F ? Vec3(0.04F, 0.03F, 0.025F) : Vec3(0.6F, 0.6F, 0.58F);
  w.pattern = static_cast<int>(hash_key(key, 8) % 4);
  w.infrared_cloth = 0.25F + 0.25F * uniform(hash_key(key, 9));
  if (!dark) return w;
  w.shirt = Vec3(0.025F, 0.025F, 0.03F), w.shirt_second = Vec3(0.05F, 0.045F, 0.04F);
  w.trousers = Vec3(0.02F, 0.02F, 0.024F), w.shoes = Vec3(0.02F, 0.018F, 0.016F);
  w.infrared_cloth = 0.02F;
  return w;
}

Wardrobe wall_coloured(Wardrobe w) {
  w.shirt = w.trousers = Vec3(0.60F, 0.58F, 0.52F);
  w.shirt_second = 0.9F * w.shirt;
  return w;
}

Materials::Materials(unsigned seed, const Wardrobe& wardrobe, const VirtualObject* object)
    : seed_(hash_key(seed, 0x5EED)), wardrobes_{wardrobe}, object_(object) {}

Vec3 Materials::room(Material material, const Vec2& uv) const {
  const int variant = material.variant;
  switch (material.kind) {
    case Kind::kFloor:
      return planks(uv, seed_);
    case Kind::kWall:
      return wallpaper(uv, variant, seed_);
    case Kind::kCeiling:
      return Vec3::Constant(0.72F + 0.06F * fractal_noise(uv * 25, 2, seed_));
    case Kind::kLamp:
      return std::max(lamp_level_, 0.05F) * Vec3(4.0F, 3.9F, 3.6F);
    case Kind::kMirror:
      return Vec3::Constant(0.02F);  // dust
    case Kind::kGlass:
      return {0.03F, 0.04F, 0.06F};  // what is behind it, by night
    case Kind::kWood:
      return wood(uv, {0.38F, 0.24F, 0.13F}, seed_ + variant);
    case Kind::kDarkWood:
      return wood(uv, {0.055F, 0.035F, 0.028F}, seed_ + 3);
    case Kind::kMetal:
      return Vec3(0.42F, 0.43F, 0.45F);
    case Kind::kPoster:
      return poster(uv, variant, seed_);
    case Kind::kBook: {
      const Vec3 cover = hash_color(hash_key(seed_, variant, 4242), 0.04F, 0.65F);
      const float band = fraction(uv.y() / 0.21F);
      return band > 0.7F && band < 0.78F ? Vec3(0.6F, 0.55F, 0.4F) : cover;
    }
    case Kind::kCloth:
      return variant == 0 ? rug(uv) : hash_color(seed_ + variant, 0.1F, 0.5F);
    case Kind::kDoor: {
      const Vec2 panel(fraction(uv.x() / 0.42F), fraction(uv.y() / 0.66F));
      const float edge = std::min({panel.x(), 1 - panel.x(), panel.y(), 1 - panel.y()});
      return (edge > 0.14F && edge < 0.17F ? 0.7F : 1.0F) * Vec3(0.66F, 0.65F, 0.61F);
    }
    default:
      return variant == 1 ? Vec3(0.10F, 0.10F, 0.11F) : Vec3(0.66F, 0.65F, 0.62F);
  }
}

Vec3 Materials::face(const Wardrobe& wardrobe, const Vec2& uv) const {
  constexpr float kTurn = 2 * std::numbers::pi_v<float>;
  const float angle = (uv.x() - 0.5F) * kTurn, side = std::abs(angle), v = uv.y();
  const float hairline = side < 0.75F ? 0.80F - 0.05F * side : side < 1.5F ? 0.72F : 0.30F;
  const float strands = 0.8F + 0.4F * value_noise({uv.x() * 160, v * 6}, seed_ + 21);
  if (v > hairline + 0.02F * std::sin(40 * angle)) return strands * wardrobe.hair;
  Vec3 color = wardrobe.skin * (0.94F + 0.1F * fractal_noise(uv * 30, 2, seed_ + 20));
  const float cheek = std::hypot((side - 0.62F) / 0.35F, (v - 0.36F) / 0.12F);
  color = mix(color, color.cwiseProduct(Vec3(1.08F, 0.86F, 0.82F)), smooth(1.0F, 0.3F, cheek));
  const float eye = std::hypot((side - 0.36F) / 0.15F, (v - 0.53F) / 0.032F);
  if (eye < 1)
    color = std::hypot((side - 0.36F) / 0.075F, (v - 0.53F) / 0.034F) < 1
                ? Vec3(0.03F, 0.025F, 0.02F)
                : Vec3(0.42F, 0.40F, 0.38F);
  if (side > 0.17F && side < 0.56F && std::abs(v - 0.605F + 0.05F * (side - 0.36F)) < 0.013F)
    color = mix(color, wardrobe.hair, 0.85F);
  if (side < 0.27F - 2 * std::abs(v - 0.215F) && std::abs(v - 0.215F) < 0.024F)
    color = color.cwiseProduct(Vec3(0.95F, 0.55F, 0.52F));
  return color;
}

Vec3 Materials::shirt(const Wardrobe& wardrobe, Material material, const Vec2& uv) const {
  const bool torso = material.variant == 0;
  const Vec2 p(uv.x() * (torso ? 0.95F : 0.3F), uv.y());
  const float weave = 0.93F + 0.14F * fractal_noise(p * 70, 2, seed_ + 30);
  Vec3 color = wardrobe.shirt;
  if (wardrobe.pattern == 1 && fraction(p.y() / 0.06F) < 0.4F) color = wardrobe.shirt_second;
  if (wardrobe.pattern == 2) {
    const float bars = (fraction(p.x() / 0.08F) < 0.3F ? 0.4F : 0.0F) +
                       (fraction(p.y() / 0.08F) < 0.3F ? 0.4F : 0.0F);
    color = mix(color, wardrobe.shirt_second, bars);
  }
  if (wardrobe.pattern == 3 && torso) {
    const Vec2 print((uv.x() - 0.5F) * 0.95F, uv.y() - 0.40F);
    const float star =
        print.norm() * (1.5F + 0.5F * std::cos(5 * std::atan2(print.x(), print.y())));
    if (star < 0.12F) color = wardrobe.shirt_second;
  }
  return weave * color;
}

Vec3 Materials::albedo(Material material, const Vec2& uv, const Vec3& position_m) const {
  const Wardrobe& wardrobe = wardrobes_[material.person];
  switch (material.kind) {
    case Kind::kSkin:
      return wardrobe.skin;
    case Kind::kFace:
      return face(wardrobe, uv);
    case Kind::kHair:
      return wardrobe.hair * (0.7F + 0.6F * value_noise({uv.x() * 120, uv.y() * 5}, seed_ + 22));
    case Kind::kStrand:
      return wardrobe.hair * (0.8F + 0.15F * static_cast<float>(material.variant % 4));
    case Kind::kStick:
      return {0.30F, 0.18F, 0.09F};
    case Kind::kBlack:
      return Vec3::Constant(0.015F);
    case Kind::kChrome:
      return Vec3::Constant(0.03F);
    case Kind::kShirt:
      return shirt(wardrobe, material, uv);
    case Kind::kTrousers: {
      const float fade = 0.85F + 0.5F * fractal_noise({uv.x() * 5, uv.y() * 9}, 3, seed_ + 31);
      const float twill = 0.9F + 0.2F * fractal_noise({uv.x() * 60, uv.y() * 160}, 2, seed_ + 32);
      return fade * twill * wardrobe.trousers;
    }
    case Kind::kShoe:
      return position_m.z() < 0.022F ? Vec3(0.5F, 0.5F, 0.48F) : wardrobe.shoes;
    case Kind::kObject: {
      const Image<Rgb8>& texture = object_->meshes[material.variant].texture;
      return sample_texture(texture, uv);
    }
    default:
      return room(material, uv).cwiseMin(material.kind == Kind::kLamp ? 9.0F : 0.9F);
  }
}

float Materials::infrared(Material material, const Vec3& visible) const {
  const float luminance = visible.dot(Vec3(0.2126F, 0.7152F, 0.0722F));
  const Wardrobe& wardrobe = wardrobes_[material.person];
  switch (material.kind) {
    case Kind::kShirt:
    case Kind::kTrousers:
      return std::min(0.85F, 0.6F * luminance + wardrobe.infrared_cloth);
    case Kind::kBlack:
      return 0.015F;
    case Kind::kChrome:
      return 0.03F;
    case Kind::kStrand:
    case Kind::kHair:
      return 0.10F + 0.5F * luminance;
    case Kind::kSkin:
    case Kind::kFace:
      return 0.45F + 0.2F * luminance;
    case Kind::kLamp:
      return 0.5F;
    case Kind::kGlass:
      return 0;  // the light goes on through it, or is mirrored away
    case Kind::kMirror:
      return 0.02F;
    default:
      return 0.15F * (material.kind == Kind::kDarkWood ? 0.2F : 1.0F) + 0.8F * luminance;
  }
}

}  // namespace mixrig::studio
