// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/look.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixrig::measure {
namespace {

constexpr int kStill = 1;             // of 255: the truth changes by no more in 3x3 pixels
constexpr int kEdge = 24;             // of 255, between the pixels beside one
constexpr std::uint64_t kLeast = 60;  // values that a bin needs

int luma(Rgb8 c) { return (77 * c.r + 150 * c.g + 29 * c.b) / 256; }

/// Properties of a pixel and its eight neighbours.
struct Around {
  bool real = true, is_virtual = true, mixed = false;  ///< one layer, in composite and truth alike
  int least = 255, most = 0;                           ///< luma of the truth
};

Around around(const ResultImages& r, const TruthImages& t, int x, int y) {
  Around a;
  bool background = false, object = false, person = false;
  for (int j = y - 1; j <= y + 1; ++j)
    for (int i = x - 1; i <= x + 1; ++i) {
      const int layer = t.labels.row(j)[i] & kLayerMask;
      a.real = a.real && layer == 0 && r.layer.row(j)[i] == 0 && t.matte.row(j)[i] == 0;
      a.is_virtual = a.is_virtual && layer == kLayerVirtual && r.layer.row(j)[i] == kLayerVirtual;
      background |= layer == 0, object |= layer == kLayerVirtual;
      person |= t.matte.row(j)[i] != 0 || r.matte.row(j)[i] != 0;
      const int l = luma(t.color.row(j)[i]);
      a.least = std::min(a.least, l), a.most = std::max(a.most, l);
    }
  a.mixed = background && object && !person;
  return a;
}

/// Whether the truth of a pixel and its neighbours is that of the frame before.
bool is_still(const TruthImages& t, const LookSums& last, int x, int y) {
  for (int j = y - 1; j <= y + 1; ++j)
    for (int i = x - 1; i <= x + 1; ++i) {
      const Rgb8 a = t.color.row(j)[i], b = last.last_truth.row(j)[i];
      if (std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}) > kStill ||
          ((t.labels.row(j)[i] ^ last.last_labels.row(j)[i]) & kLayerMask) != 0)
        return false;
    }
  return true;
}

/// Mean over the channels of the squared response of the change from frame to frame to the mask of
/// Immerkaer 1996, which a change of exposure does not move: that of white noise is its variance.
double noise_square(ImageView<const Rgb8> color, const Image<Rgb8>& last, int x, int y) {
  constexpr std::array<std::array<int, 3>, 3> kMask{{{1, -2, 1}, {-2, 4, -2}, {1, -2, 1}}};
  std::array<int, 3> sum{};
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const Rgb8 c = color.row(y + j - 1)[x + i - 1], d = last.row(y + j - 1)[x + i - 1];
      const int by = kMask[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
      sum[0] += by * (c.r - d.r), sum[1] += by * (c.g - d.g), sum[2] += by * (c.b - d.b);
    }
  return (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / (2 * 3.0 * 36.0);
}

void keep(ImageView<const Rgb8> from, Image<Rgb8>& to) {
  to.reset(from.size);
  for (int y = 0; y < from.size.height; ++y) std::copy_n(from.row(y), from.size.width, to.row(y));
}

void add_slope(const ResultImages& r, const TruthImages& t, int x, int y, LookSums::Slope& slope) {
  const auto gradient = [&](ImageView<const Rgb8> color) {
    return std::pair(luma(color.row(y)[x + 1]) - luma(color.row(y)[x - 1]),
                     luma(color.row(y + 1)[x]) - luma(color.row(y - 1)[x]));
  };
  const auto [tx, ty] = gradient(t.color);
  if (tx * tx + ty * ty < kEdge * kEdge) return;
  const auto [rx, ry] = gradient(r.color);
  slope.products += rx * tx + ry * ty;
  slope.squares += tx * tx + ty * ty;
}

std::optional<double> share(const LookSums::Slope& slope) {
  return slope.squares > 0 ? std::optional(slope.products / slope.squares) : std::nullopt;
}

}  // namespace

void add_look(const ResultImages& result, const TruthImages& truth, LookSums& sums) {
  const bool has_last = sums.last_color.size() == result.color.size;
  for (int y = 1; y + 1 < truth.labels.size.height; ++y)
    for (int x = 1; x + 1 < truth.labels.size.width; ++x) {
      const Around a = around(result, truth, x, y);
      if (has_last && (a.real || a.is_virtual) && is_still(truth, sums, x, y)) {
        const auto bin =
            static_cast<std::size_t>(luma(truth.color.row(y)[x])) * LookSums::kBins / 256;
        (a.real ? sums.real_noise : sums.virtual_noise)[bin].add(
            noise_square(result.color, sums.last_color, x, y));
      }
      if (a.most - a.least < kEdge) continue;
      if (a.real) add_slope(result, truth, x, y, sums.real);
      if (a.is_virtual) add_slope(result, truth, x, y, sums.virtual_inside);
      if (a.mixed) add_slope(result, truth, x, y, sums.outline);
    }
  keep(result.color, sums.last_color), keep(truth.color, sums.last_truth);
  sums.last_labels.reset(truth.labels.size);
  for (int y = 0; y < truth.labels.size.height; ++y)
    std::copy_n(truth.labels.row(y), truth.labels.size.width, sums.last_labels.row(y));
}

Errors::Look look_of(const LookSums& sums) {
  double real = 0, of_virtual = 0, weights = 0;
  for (std::size_t i = 0; i < LookSums::kBins; ++i) {
    const Sum &a = sums.real_noise[i], &b = sums.virtual_noise[i];
    if (std::min(a.count, b.count) < kLeast) continue;
    const auto weight = static_cast<double>(b.count);
    real += weight * *a.mean(), of_virtual += weight * *b.mean(), weights += weight;
  }
  Errors::Look look;
  if (weights > 0) {
    look.real_noise = std::sqrt(real / weights);
    look.virtual_noise = std::sqrt(of_virtual / weights);
  }
  look.real_sharpness = share(sums.real);
  look.virtual_sharpness = share(sums.virtual_inside);
  look.outline_sharpness = share(sums.outline);
  return look;
}

}  // namespace mixrig::measure
