// SPDX-License-Identifier: Apache-2.0
#include "studio/sensors/raw_pictures.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace mixrig::studio {
namespace {

constexpr int kPictureWide = 512, kPictureHigh = 424, kPictures = 10;
constexpr std::size_t kRowBytes = kPictureWide * 11 / 8, kPictureBytes = kRowBytes * kPictureHigh;
constexpr std::size_t kFooterBytes = 38 * 4;
constexpr float kRawPi = std::numbers::pi_v<float>;
constexpr std::array<double, 3> kRange_m{1.875, 9.375, 1.25};
/// Modulation contrast of each frequency: the inverse of the factors that make their amplitudes
/// equal.
constexpr std::array<float, 3> kContrast{0.9F / 1.322581F, 0.9F, 0.9F / 1.612903F};
constexpr float kElectronsPerCount = 10;
constexpr float kOffsetStep_rad = 0.000031F * kRawPi;
constexpr std::array<int, 3> kOffset{0x2C9A, 0x08EC, 0x42E8};
constexpr std::uint16_t kSaturated = 1024;  ///< minus zero
constexpr double kLightRight_m = -0.045, kTicksPerSecond = 8000;

/// Sign, exponent of three bits and seven bits of mantissa, to the nearest.
std::uint16_t compressed(float counts) {
  const auto value = static_cast<int>(std::lround(std::abs(counts)));
  int exponent = 0, code = value;
  while (value >> exponent >= 256) ++exponent;
  if (exponent > 0) {
    code = (value + (1 << (exponent - 1))) >> exponent;
    if (code == 256) code = 128, ++exponent;
    code += 128 * exponent;
  }
  if (code > 1023) return kSaturated;
  return static_cast<std::uint16_t>(code == 0 || counts > 0 ? code : code + 1024);
}

/// Position of a pixel in the sensor's data: rows run from the top and from the bottom to the
/// middle, columns are mirrored and every fourth one is stored together.
std::size_t bit_of(int x, int y) {
  const int column = kPictureWide - 1 - x;
  const int row = y < kPictureHigh / 2 ? y : kPictureHigh / 2 + kPictureHigh - 1 - y;
  return (static_cast<std::size_t>(row) * kPictureWide + (column >> 2) + ((column & 3) << 7)) * 11;
}

void put_u32(std::vector<std::uint8_t>& out, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}
void put_u16(std::vector<std::uint8_t>& out, std::uint16_t value) {
  out.push_back(static_cast<std::uint8_t>(value));
  out.push_back(static_cast<std::uint8_t>(value >> 8));
}

}  // namespace

TofSensor raw_sensor(TofSensor s) {
  s.fine_hz = kLight_m_s / (2 * kRange_m[0]);
  s.coarse_hz = kLight_m_s / (2 * kRange_m[1]);
  s.third_hz = kLight_m_s / (2 * kRange_m[2]);
  s.light_x_m = kLightRight_m;
  return s;
}

RawPictures::RawPictures(const TofSensor& sensor, unsigned seed) : sensor_(sensor) {
  for (std::size_t f = 0; f < offsets_.size(); ++f) {
    offsets_[f].resize(std::size_t{kPictureWide} * kPictureHigh);
    for (int y = 0; y < kPictureHigh; ++y)
      for (int x = 0; x < kPictureWide; ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * kPictureWide + x;
        // The way to the pixel's electronics, and its own deviation.
        const float way = 900 * std::cos(0.004F * static_cast<float>(x)) +
                          2.0F * std::abs(static_cast<float>(y) - 0.5F * kPictureHigh);
        const float own = 60 * normal_(hash_key(seed, 0x0FF5E7 + f, pixel));
        const bool rim = x == 0 || x == kPictureWide - 1;
        offsets_[f][pixel] = static_cast<std::uint16_t>(
            std::lround(static_cast<float>(kOffset[f]) + (rim ? 0 : way + own)));
      }
  }
}

std::uint16_t RawPictures::sample(const Echo& e, int frequency, int step, std::size_t pixel,
                                  std::uint64_t bits) const {
  const auto f = static_cast<std::size_t>(frequency);
  const float c = f == 0 ? e.fine_cos : f == 1 ? e.coarse_cos : e.third_cos;
  const float s = f == 0 ? e.fine_sin : f == 1 ? e.coarse_sin : e.third_sin;
  const float turn = static_cast<float>(step) * 2 * kRawPi / 3 -
                     kOffsetStep_rad * static_cast<float>(offsets_[f][pixel]);
  const float modulated = kContrast[f] * (c * std::cos(turn) - s * std::sin(turn));
  std::array<float, 2> tap;
  for (int i = 0; i < 2; ++i) {
    const float mean = 0.5F * sensor_.signal_e * (e.strength + (i == 0 ? modulated : -modulated)) +
                       sensor_.background_e * e.albedo;
    const float sigma =
        std::sqrt(std::max(mean, 0.0F) + sensor_.read_noise_e * sensor_.read_noise_e);
    tap[i] = mean + sigma * normal_(bits >> (12 * i));
    if (tap[i] > sensor_.full_well_e) return kSaturated;
  }
  return compressed((tap[0] - tap[1]) / kElectronsPerCount);
}

void RawPictures::expose(std::span<const std::array<Echo, 4>> taps, std::uint64_t key, int number,
                         double time_s, std::vector<std::uint8_t>& out) const {
  out.clear();
  for (int picture = 0; picture < kPictures; ++picture) {
    const std::size_t begin = out.size();
    out.resize(begin + kPictureBytes);
    const auto tap = static_cast<std::size_t>(picture * 4 / 9);
    for (int y = 0; y < kPictureHigh && picture < 9; ++y)
      for (int x = 0; x < kPictureWide; ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * kPictureWide + x;
        const std::uint64_t bits = mix_bits(hash_key(key, static_cast<unsigned>(picture), pixel));
        const std::size_t at = bit_of(x, y);
        const std::uint32_t shifted =
            std::uint32_t{sample(taps[pixel][tap], picture / 3, picture % 3, pixel, bits)}
            << (at & 7);
        for (std::size_t i = 0; i < 3 && shifted >> (8 * i) != 0; ++i)
          out[begin + at / 8 + i] |= static_cast<std::uint8_t>(shifted >> (8 * i));
      }
    put_u32(out, 0), put_u32(out, 0);  // two numbers of no published value
    put_u32(out, static_cast<std::uint32_t>(std::llround(kTicksPerSecond * time_s)));
    put_u32(out, static_cast<std::uint32_t>(number));
    put_u32(out, static_cast<std::uint32_t>(picture));
    put_u32(out, kPictureBytes);
    out.resize(begin + kPictureBytes + kFooterBytes);
  }
}

RawTables RawPictures::tables() const {
  RawTables tables;
  std::vector<std::uint8_t>& out = tables.phase_offsets;
  for (int i = 0; i < 8; ++i) put_u32(out, 0);
  for (const auto& table : offsets_) {
    put_u16(out, 0);
    for (int y = 0; y < kPictureHigh; ++y)
      for (int x = 0; x < kPictureWide; ++x)
        put_u16(out, table[static_cast<std::size_t>(y) * kPictureWide + (kPictureWide - 1 - x)]);
    put_u16(out, 0);
  }
  const Optics& o = sensor_.optics;
  const auto put = [&](double v) {
    put_u32(tables.infrared, std::bit_cast<std::uint32_t>(static_cast<float>(v)));
  };
  // The device's picture is mirrored, and a pixel's centre is at half a pixel.
  const auto& [k1, k2, p1, p2, k3] = o.distortion;
  for (const double v :
       {o.fx_px, o.fy_px, 0.0, kPictureWide - 0.5 - o.cx_px, o.cy_px + 0.5, k1, k2, p1, -p2, k3})
    put(v);
  for (int i = 0; i < 13; ++i) put(0);
  return tables;
}

}  // namespace mixrig::studio
