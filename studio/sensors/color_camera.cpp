// SPDX-License-Identifier: Apache-2.0
// The target camera from light to an sRGB picture.
#include "studio/sensors/color_camera.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "studio/srgb.h"

namespace mixrig::studio {
namespace {

constexpr int kColorBand = 8;
constexpr int kReach_px = 8;  ///< largest radius of a circle of confusion

/// Share of a disc of radius r around a pixel that falls on a pixel `d` away, up to a factor.
float cover(float d, float r) { return std::clamp(r + 0.5F - d, 0.0F, 1.0F); }

/// Sum of cover() over all pixels, for radii in steps of 1 / kSteps px.
class DiscArea {
 public:
  DiscArea() {
    for (std::size_t i = 0; i < area_.size(); ++i) {
      const float r = static_cast<float>(i) / kSteps;
      for (int y = -kReach_px - 1; y <= kReach_px + 1; ++y)
        for (int x = -kReach_px - 1; x <= kReach_px + 1; ++x)
          area_[i] += cover(std::hypot(static_cast<float>(x), static_cast<float>(y)), r);
    }
  }
  float operator()(float r) const { return area_[static_cast<std::size_t>(r * kSteps + 0.5F)]; }

 private:
  static constexpr int kSteps = 32;
  std::array<float, static_cast<std::size_t>(kReach_px) * kSteps + 1> area_{};
};

int mirrored(int i, int n) {
  if (n == 1) return 0;
  if (i < 0) i = -i;
  return i < n ? i : 2 * (n - 1) - i;
}

}  // namespace

Gain gain_at(unsigned seed, double time_s) {
  const auto t = static_cast<float>(time_s);
  const auto drift = [&](unsigned salt, float rate_hz) {
    return 0.5F * (wander(rate_hz * t, seed + salt) - wander(0, seed + salt));
  };
  return {std::exp2(0.12F * drift(501, 0.5F)), 1 + 0.03F * drift(502, 0.3F),
          1 + 0.03F * drift(503, 0.3F)};
}

float blur_circle_px(const ColorSensor& sensor, float f_px, float z_m) {
  return sensor.aperture_m * f_px * std::abs(1 / z_m - 1 / sensor.focus_m);
}

void defocus(const ColorSensor& sensor, float f_px, const Image<Rgbf>& light,
             const Image<float>& z_m, Crew& crew, Image<Rgbf>& blurred) {
  static const DiscArea area;
  const Size size = light.size();
  Image<float> radius(size);
  float widest = 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const float r = 0.5F * blur_circle_px(sensor, f_px, z_m.at(x, y));
      radius.at(x, y) = std::min(r, static_cast<float>(kReach_px));
      widest = std::max(widest, radius.at(x, y));
    }
  const int reach = static_cast<int>(std::ceil(widest + 0.5F));
  blurred.reset(size);
  crew.rows(size.height, kColorBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const float own = radius.at(x, y), z = z_m.at(x, y);
        Vec3 sum = Vec3::Zero();
        float total = 0;
        for (int j = std::max(0, y - reach); j <= std::min(size.height - 1, y + reach); ++j)
          for (int i = std::max(0, x - reach); i <= std::min(size.width - 1, x + reach); ++i) {
            const float r = z_m.at(i, j) > z ? std::min(radius.at(i, j), own) : radius.at(i, j);
            const float d = std::sqrt(static_cast<float>((i - x) * (i - x) + (j - y) * (j - y)));
            if (d >= r + 0.5F) continue;
            const float weight = cover(d, r) / area(r);
            const Rgbf& c = light.at(i, j);
            sum += weight * Vec3(c.r, c.g, c.b);
            total += weight;
          }
        sum /= total;
        blurred.at(x, y) = {sum[0], sum[1], sum[2]};
      }
  });
}

void expose(const ColorSensor& sensor, const Image<Rgbf>& light, std::uint64_t key,
            const NormalTable& normal, Crew& crew, Image<float>& raw) {
  const Size size = light.size();
  raw.reset(size);
  crew.rows(size.height, kColorBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const int channel = bayer_channel(x, y);
        const Rgbf& c = light.at(x, y);
        const float charge = sensor.full_well_e * sensor.response[channel] *
                             (channel == 0   ? c.r
                              : channel == 1 ? c.g
                                             : c.b);
        const std::uint64_t pixel =
            static_cast<std::uint64_t>(y) * 65536 + static_cast<unsigned>(x);
        const float noisy = charge + std::sqrt(charge + sensor.read_noise_e * sensor.read_noise_e) *
                                         normal(hash_key(key, pixel));
        // The black level lies above zero, so that dark values are not clipped.
        const float share = std::min(noisy / sensor.full_well_e, 1.0F);
        raw.at(x, y) = std::round(share * sensor.levels) / sensor.levels;
      }
  });
}

Rgbf demosaic_at(ImageView<const float> raw, int x, int y) {
  const auto at = [&](int i, int j) {
    return raw.at(mirrored(x + i, raw.size.width), mirrored(y + j, raw.size.height));
  };
  const float here = at(0, 0);
  const float cross = at(-1, 0) + at(1, 0) + at(0, -1) + at(0, 1);
  const float across2 = at(-2, 0) + at(2, 0), down2 = at(0, -2) + at(0, 2);
  const float corners = at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1);
  const int channel = bayer_channel(x, y);
  if (channel != 1) {
    const float green = (4 * here + 2 * cross - across2 - down2) / 8;
    const float other = (6 * here + 2 * corners - 1.5F * (across2 + down2)) / 8;
    return channel == 0 ? Rgbf{here, green, other} : Rgbf{other, green, here};
  }
  const float in_row =
      (5 * here + 4 * (at(-1, 0) + at(1, 0)) - across2 - corners + 0.5F * down2) / 8;
  const float in_column =
      (5 * here + 4 * (at(0, -1) + at(0, 1)) - down2 - corners + 0.5F * across2) / 8;
  // Green pixels of even rows have red neighbours in their row.
  return (y & 1) == 0 ? Rgbf{in_row, here, in_column} : Rgbf{in_column, here, in_row};
}

void halve_chroma(Image<Rgb8>& picture, Crew& crew) {
  const auto byte = [](float v) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0F, 255.0F)));
  };
  const auto luma = [](const Rgb8& c) {
    return 0.299F * static_cast<float>(c.r) + 0.587F * static_cast<float>(c.g) +
           0.114F * static_cast<float>(c.b);
  };
  crew.rows(picture.height(), kColorBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x + 1 < picture.width(); x += 2) {
        Rgb8& a = picture.at(x, y);
        Rgb8& b = picture.at(x + 1, y);
        float blue = 0, red = 0;
        for (const Rgb8& c : {a, b}) {
          blue += 0.5F * (static_cast<float>(c.b) - luma(c)) / 1.772F;
          red += 0.5F * (static_cast<float>(c.r) - luma(c)) / 1.402F;
        }
        blue = std::round(blue), red = std::round(red);
        for (Rgb8* c : {&a, &b}) {
          const float grey = std::round(luma(*c));
          *c = {byte(grey + 1.402F * red), byte(grey - 0.344136F * blue - 0.714136F * red),
                byte(grey + 1.772F * blue)};
        }
      }
  });
}

namespace {

/// White balance, before demosaicing: the filters expect colours that change together.
void balance(Image<float>& raw, const Vec3& response, const Gain& gain) {
  const Vec3 factor = Vec3(gain.red, 1, gain.blue).cwiseQuotient(response);
  for (int y = 0; y < raw.height(); ++y)
    for (int x = 0; x < raw.width(); ++x) raw.at(x, y) *= factor[bayer_channel(x, y)];
}

}  // namespace

ColorCamera::ColorCamera(const Optics& optics, const Realism& realism, unsigned seed)
    : optics_(optics), realism_(realism), seed_(seed), rays_(optics) {}

void ColorCamera::attenuate(Image<Rgbf>& light, float exposure, Crew& crew) const {
  crew.rows(light.height(), kColorBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < light.width(); ++x) {
        float share = exposure;
        if (realism_.vignetting) {
          const Vec2 p = rays_.at(static_cast<float>(x), static_cast<float>(y));
          share *= std::pow(1 + p.squaredNorm(), -0.5F * sensor_.falloff);
        }
        Rgbf& c = light.at(x, y);
        c = {share * c.r, share * c.g, share * c.b};
      }
  });
}

void ColorCamera::develop(Image<Rgbf>& light, const Image<float>& z_m, int number, double time_s,
                          Crew& crew, Image<Rgb8>& picture) {
  if (realism_.defocus) {
    defocus(sensor_, static_cast<float>(optics_.fx_px), light, z_m, crew, blurred_);
    std::swap(light, blurred_);
  }
  const Gain gain = realism_.gain_drift ? gain_at(seed_, time_s) : Gain{};
  if (realism_.gain_drift || realism_.vignetting) attenuate(light, gain.exposure, crew);
  const std::uint64_t key = hash_key(hash_key(seed_, 0xC0103), static_cast<std::uint64_t>(number));
  if (realism_.mosaic) {
    expose(sensor_, light, key, normal_, crew, raw_);
    balance(raw_, sensor_.response, gain);
  }
  picture.reset(light.size());
  crew.rows(light.height(), kColorBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < light.width(); ++x) {
        Vec3 c;
        if (realism_.mosaic) {
          const Rgbf m = demosaic_at(raw_, x, y);
          c = Vec3(m.r, m.g, m.b);
        } else {
          const Rgbf& l = light.at(x, y);
          const std::uint64_t pixel =
              static_cast<std::uint64_t>(y) * 65536 + static_cast<unsigned>(x);
          const std::uint64_t bits = hash_key(key, pixel);
          c = Vec3(l.r, l.g, l.b);
          for (int i = 0; i < 3; ++i) {
            const float charge = sensor_.full_well_e * c[i];
            c[i] += std::sqrt(charge + sensor_.read_noise_e * sensor_.read_noise_e) *
                    normal_(bits >> (12 * i)) / sensor_.full_well_e;
          }
          c[0] *= gain.red, c[2] *= gain.blue;
        }
        picture.at(x, y) = srgb_from_linear(c);
      }
  });
  if (realism_.chroma) halve_chroma(picture, crew);
}

}  // namespace mixrig::studio
