// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/plate/stray_pieces.h"

#include <algorithm>
#include <array>
#include <bit>

namespace mixrig::render::cpu {
namespace {

using Stride = std::ptrdiff_t;

constexpr int kWindowRows = 2 * kStrayReachPx + 3;  ///< the outermost ones are where no piece ends
static_assert(kWindowRows <= 32);
constexpr int kMiddle = kStrayReachPx + 1;
constexpr std::uint32_t kOutermost = 1U | 1U << (kWindowRows - 1);

/// A row of the window around a pixel, a bit a pixel: 1 where depth is known and at most `limit_m`.
std::uint32_t near_pixels(const float* row, float limit_m) {
  std::uint32_t near = 0;
  for (int i = 0; i < kWindowRows; ++i)
    near |= static_cast<std::uint32_t>((row[i] > 0) & (row[i] <= limit_m)) << i;
  return near;
}

constexpr int kTooLarge = kWindowRows * kWindowRows;

/// Number of pixels that are connected with *p; kTooLarge for more than `most` and where they reach
/// the window's border. Rows are read as the piece grows into them.
int piece_px(const float* p, Stride stride, int most) {
  std::array<std::uint32_t, kWindowRows> near{}, piece{};
  const auto read = [&](int row) {
    near[static_cast<std::size_t>(row)] =
        near_pixels(p + (row - kMiddle) * stride - kMiddle, kStrayGap * *p);
  };
  int first = kMiddle, last = kMiddle, count = 0;
  read(kMiddle);
  piece[kMiddle] = 1U << kMiddle;
  for (bool grows = true; grows;) {
    if (piece[static_cast<std::size_t>(first)] != 0) read(--first);
    if (piece[static_cast<std::size_t>(last)] != 0) read(++last);
    if (first == 0 || last == kWindowRows - 1) return kTooLarge;
    grows = false, count = 0;
    for (auto j = static_cast<std::size_t>(first); j <= static_cast<std::size_t>(last); ++j) {
      const std::uint32_t rows = piece[j - 1] | piece[j] | piece[j + 1];
      const std::uint32_t joined = near[j] & (rows | rows << 1 | rows >> 1);
      grows |= joined != piece[j];
      piece[j] = joined;
      count += std::popcount(joined);
      if (joined & kOutermost) return kTooLarge;
    }
    if (count > most) return kTooLarge;
  }
  return count;
}

/// Whether of each two opposite pixels at the reach at least one is unknown or farther: cheap, and
/// false almost everywhere.
void may_be_stray(const float* z_m, Stride stride, int width, std::uint8_t* may) {
  constexpr Stride kReach = kStrayReachPx;
  for (int x = 0; x < width; ++x) {
    const float* p = z_m + x;
    const float limit = kStrayGap * p[0];
    const auto near = [&](Stride d) { return (p[d] > 0) & (p[d] <= limit); };
    const auto both = [&](Stride d) { return near(d) & near(-d); };
    const bool runs_through = both(kReach) | both(kReach * stride) | both(kReach * (stride + 1)) |
                              both(kReach * (stride - 1));
    may[x] = (p[0] > 0) & !runs_through;
  }
}

}  // namespace

void drop_stray_pieces(const CorrectParams& params, const float* z_m, Stride stride, int y,
                       Size size, float* out_m) {
  std::copy_n(z_m, size.width, out_m);
  if (params.stray_px_m2 <= 0 || y < kStrayBorderPx || y >= size.height - kStrayBorderPx) return;
  constexpr int kRun = 256;
  std::array<std::uint8_t, kRun> may;
  const int last = size.width - kStrayBorderPx;
  for (int x0 = kStrayBorderPx; x0 < last; x0 += kRun) {
    const int count = std::min(kRun, last - x0);
    may_be_stray(z_m + x0, stride, count, may.data());
    for (int i = 0; i < count; ++i) {
      if (!may[static_cast<std::size_t>(i)]) continue;
      const float* p = z_m + x0 + i;
      const int most = static_cast<int>(std::min(params.stray_px_m2 / (*p * *p), 1.0F * kTooLarge));
      if (piece_px(p, stride, most) <= most) out_m[x0 + i] = 0;
    }
  }
}

}  // namespace mixrig::render::cpu
