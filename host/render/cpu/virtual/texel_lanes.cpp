// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/virtual/texel_lanes.h"

#include "host/render/cpu/plate/srgb.h"

namespace mixrig::render::cpu {
namespace {

constexpr FloatLanes kNothing{};
constexpr FloatLanes kFull = FloatLanes{} + 1.0F;
/// Largest texture coordinate; beyond it the texture is white.
constexpr float kFarthestPlace = 1e6F;
constexpr int kSpan = 3;  ///< texels along a side that samples may share

/// Largest integer not above f; the value must fit.
FloatLanes floor_of(FloatLanes f) {
  const FloatLanes whole = to_float(truncate(f));
  return whole + to_float(whole > f);  // true is -1
}

/// Wraps texel numbers, from -1 on, of a repeating texture.
IntLanes wrapped(IntLanes i, int size) {
  i = i < 0 ? i + size : i;
  while (any(i >= size)) i = i >= size ? i - size : i;
  return i;
}

/// Positions of samples along an axis of the texture, between texels from `origin` on.
struct Along {
  IntLanes origin{};                                ///< from -1 on, below size
  std::array<IntLanes, kPixelSamples> from_origin;  ///< texel below each sample; at most kSpan
  SampleLanes share;                                ///< fraction of the way to the next texel
  IntLanes most{};                                  ///< largest from_origin
};
Along along_axis(const SampleLanes& at, const SampleLanes& counted, int size) {
  FloatLanes least = kNothing + kFarthestPlace;
  for (std::size_t s = 0; s < kPixelSamples; ++s)
    least = counted[s] > 0 ? min(least, at[s]) : least;
  const FloatLanes whole = floor_of(least);
  const FloatLanes first = floor_of((least - whole) * static_cast<float>(size) - 0.5F);
  Along out;
  out.origin = truncate(first);
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    const FloatLanes texel = (at[s] - whole) * static_cast<float>(size) - 0.5F - first;
    const FloatLanes on = counted[s] > 0 ? max(texel, kNothing) : kNothing;
    const FloatLanes low = floor_of(min(on, kNothing + static_cast<float>(kSpan)));
    out.share[s] = on - low, out.from_origin[s] = truncate(low);
    out.most = out.from_origin[s] > out.most ? out.from_origin[s] : out.most;
  }
  return out;
}

/// Reads texels of a texture.
class TexelReader {
 public:
  explicit TexelReader(ImageView<const Rgb8> texture)
      : data_(texture.data),
        last_byte_(kBytes * static_cast<std::int32_t>(texture.stride * (texture.size.height - 1) +
                                                      texture.size.width) -
                   static_cast<std::int32_t>(sizeof(std::int32_t))) {}
  /// `texel`: its index in the picture.
  void add(IntLanes texel, FloatLanes weight, ColorLanes& sum) const {
    const IntLanes at = kBytes * texel;
    // The last texel has no fourth byte behind it.
    const IntLanes from = at < last_byte_ ? at : IntLanes{} + last_byte_;
    const IntLanes rgb = gather_bytes(data_, from) >> (8 * (at - from));
    const float* const table = linear_of_byte().data();
    sum.r += weight * gather(table, rgb & 255);
    sum.g += weight * gather(table, (rgb >> 8) & 255);
    sum.b += weight * gather(table, (rgb >> 16) & 255);
  }

 private:
  static constexpr std::int32_t kBytes = sizeof(Rgb8);
  const Rgb8* data_;
  std::int32_t last_byte_;
};

/// Weight of texel `i` from the origin for a sample.
FloatLanes weight_of(const Along& a, std::size_t sample, int i) {
  const IntLanes low = a.from_origin[sample];
  const FloatLanes second = low + 1 == i ? a.share[sample] : kNothing;
  return low == i ? 1 - a.share[sample] : second;
}

/// Sums samples that lie between the same 3x3 texels, or fewer.
void add_shared(ImageView<const Rgb8> texture, const Along& x, const Along& y,
                const SampleLanes& counted, ColorLanes& sum) {
  const TexelReader reader(texture);
  const int columns = any(x.most > 0) ? kSpan : kSpan - 1;
  const int rows = any(y.most > 0) ? kSpan : kSpan - 1;
  std::array<IntLanes, kSpan> column;
  for (int i = 0; i < columns; ++i)
    column[static_cast<std::size_t>(i)] = wrapped(x.origin + i, texture.size.width);
  for (int j = 0; j < rows; ++j) {
    const IntLanes row =
        wrapped(y.origin + j, texture.size.height) * static_cast<std::int32_t>(texture.stride);
    SampleLanes down;
    for (std::size_t s = 0; s < kPixelSamples; ++s) down[s] = counted[s] * weight_of(y, s, j);
    for (int i = 0; i < columns; ++i) {
      FloatLanes weight{};
      for (std::size_t s = 0; s < kPixelSamples; ++s) weight += down[s] * weight_of(x, s, i);
      reader.add(row + column[static_cast<std::size_t>(i)], weight, sum);
    }
  }
}

/// Sums each sample by itself.
void add_apart(ImageView<const Rgb8> texture, const SampleLanes& x, const SampleLanes& y,
               const SampleLanes& counted, ColorLanes& sum) {
  const TexelReader reader(texture);
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    SampleLanes only{};
    only[s] = counted[s];
    if (!any(only[s] > 0)) continue;
    const Along across = along_axis(x, only, texture.size.width);
    const Along down = along_axis(y, only, texture.size.height);
    for (int corner = 0; corner < 4; ++corner) {
      const int i = corner & 1, j = corner >> 1;
      const IntLanes row = wrapped(down.origin + j, texture.size.height);
      reader.add(row * static_cast<std::int32_t>(texture.stride) +
                     wrapped(across.origin + i, texture.size.width),
                 counted[s] * weight_of(across, s, i) * weight_of(down, s, j), sum);
    }
  }
}

}  // namespace

ColorLanes sum_of_texels(ImageView<const Rgb8> texture, const SampleLanes& u, const SampleLanes& v,
                         const SampleLanes& w, const SampleLanes& counted) {
  SampleLanes x, y, near;
  FloatLanes white{};
  for (std::size_t s = 0; s < kPixelSamples; ++s) {
    const FloatLanes z = 1 / (counted[s] > 0 ? w[s] : kFull);
    x[s] = u[s] * z, y[s] = v[s] * z;
    const IntLanes sane = (abs(x[s]) < kFarthestPlace) & (abs(y[s]) < kFarthestPlace);
    near[s] = sane ? counted[s] : kNothing;
    white += counted[s] - near[s];
  }
  const Along across = along_axis(x, near, texture.size.width);
  const Along down = along_axis(y, near, texture.size.height);
  const IntLanes spread = (across.most > kSpan - 2) | (down.most > kSpan - 2);
  SampleLanes together, apart;
  for (std::size_t s = 0; s < kPixelSamples; ++s)
    together[s] = spread ? kNothing : near[s], apart[s] = spread ? near[s] : kNothing;
  ColorLanes sum{white, white, white};
  if (any(~spread)) add_shared(texture, across, down, together, sum);
  if (any(spread)) add_apart(texture, x, y, apart, sum);
  return sum;
}

}  // namespace mixrig::render::cpu
