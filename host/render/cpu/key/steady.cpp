// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/steady.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/contract/compositor.h"
#include "host/render/contract/constants.h"

namespace mixrig::render::cpu {
namespace {

constexpr int kWide = kBlockPx + 2;

/// Difference of two pixels: about that of the roots of the channels, summed, up to a factor.
float difference(Rgbx16 a, Rgbx16 b) {
  const auto apart = [](std::uint16_t p, std::uint16_t q) {
    return std::abs(static_cast<float>(p) - static_cast<float>(q));
  };
  const float light = static_cast<float>(a.r) + static_cast<float>(a.g) + static_cast<float>(a.b) +
                      static_cast<float>(b.r) + static_cast<float>(b.g) + static_cast<float>(b.b);
  return (apart(a.r, b.r) + apart(a.g, b.g) + apart(a.b, b.b)) / std::sqrt(light + 1);
}

/// Approximates kBeforeShare exp(-x); 0 from x = 4 on.
float share_by(float x) {
  const float t = std::max(0.0F, 1 - 0.25F * x), t2 = t * t;
  return kBeforeShare * t2 * t2;
}

/// Share of the previous matte in each pixel of a block, by likeness of 3x3 pixels.
using BlockShare = std::array<std::array<float, kBlockPx>, kBlockPx>;

/// Pixels of a row from x0 on; beyond its ends the end pixels repeat.
using Row = std::array<Rgbx16, kWide>;
Row row_of(const Rgbx16* row, int x0, int last_x) {
  Row out;
  if (x0 >= 0 && x0 + kWide <= last_x + 1) {
    std::copy_n(row + x0, kWide, out.begin());
    return out;
  }
  for (int i = 0; i < kWide; ++i)
    out[static_cast<std::size_t>(i)] = row[std::clamp(x0 + i, 0, last_x)];
  return out;
}

/// Blends the previous matte into the matte of a frame.
struct Join {
  const Image<Rgbx16>& plate;
  const Image<std::uint8_t>& state;
  const FrameBefore& before;
  Image<std::uint8_t>& matte;

  void block(int bx, int by) const;
  bool differs(int x0, int y0) const;
  BlockShare compare(int x0, int y0) const;
  bool may_be_people(int x, int y) const;
};

/// False where the depth camera measures background at the pixel and on all sides.
bool Join::may_be_people(int x, int y) const {
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const int u = std::clamp(x + i * before.reach_px, 0, matte.width() - 1);
      const int v = std::clamp(y + j * before.reach_px, 0, matte.height() - 1);
      if (state.row(v)[u] != static_cast<std::uint8_t>(PixelState::kBackground)) return true;
    }
  return false;
}

/// Whether the block's matte has changed at all.
bool Join::differs(int x0, int y0) const {
  const int width = std::min(kBlockPx, matte.width() - x0);
  for (int y = y0; y < std::min(y0 + kBlockPx, matte.height()); ++y)
    if (!std::equal(matte.row(y) + x0, matte.row(y) + x0 + width, before.matte.row(y) + x0))
      return true;
  return false;
}

/// Compares a block with the previous frame. Beyond the picture its border repeats.
BlockShare Join::compare(int x0, int y0) const {
  // The roots of three channels differ by about sqrt(6) / 2 times (sum |a - b|) / sqrt(sum of the
  // six values).
  constexpr float kScale = 255.0F * 1.2247449F / 27;
  const float scale = kScale / std::sqrt(static_cast<float>(kLinearOne));
  const int last_x = plate.width() - 1, last_y = plate.height() - 1;
  std::array<std::array<float, kWide>, kWide> d;
  for (int j = 0; j < kWide; ++j) {
    const int y = std::clamp(y0 + j - 1, 0, last_y);
    const Row now = row_of(plate.row(y), x0 - 1, last_x);
    const Row then = row_of(before.plate.row(y), x0 - 1, last_x);
    for (std::size_t i = 0; i < kWide; ++i)
      d[static_cast<std::size_t>(j)][i] = difference(now[i], then[i]);
  }
  BlockShare share;
  for (std::size_t j = 0; j < kBlockPx; ++j)
    for (std::size_t i = 0; i < kBlockPx; ++i) {
      float sum = 0;
      for (std::size_t dj = 0; dj < 3; ++dj)
        for (std::size_t di = 0; di < 3; ++di) sum += d[j + dj][i + di];
      const float off = scale * sum / kBeforeAlike;
      share[j][i] = share_by(off * off);
    }
  return share;
}

void Join::block(int bx, int by) const {
  const int x0 = block_begin(bx), y0 = block_begin(by);
  if (!differs(x0, y0)) return;
  const BlockShare share = compare(x0, y0);
  for (int y = y0; y < block_end(by, matte.height()); ++y)
    for (int x = x0; x < block_end(bx, matte.width()); ++x) {
      const std::uint8_t now = matte.row(y)[x], then = before.matte.row(y)[x];
      if (then > now && !may_be_people(x, y)) continue;
      const float part = share[static_cast<std::size_t>(y - y0)][static_cast<std::size_t>(x - x0)];
      matte.row(y)[x] = static_cast<std::uint8_t>(static_cast<float>(now) +
                                                  part * static_cast<float>(then - now) + 0.5F);
    }
}

}  // namespace

void join_before(Crew& crew, const Image<Rgbx16>& plate, const BlockPlanes& blocks,
                 const Image<std::uint8_t>& state, const FrameBefore& before,
                 Image<std::uint8_t>& matte) {
  constexpr int kGrain = 2;
  const Join join{plate, state, before, matte};
  crew.rows(blocks.decided.height(), kGrain, [&](int begin, int end) {
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < blocks.decided.width(); ++bx)
        if (blocks.decided.row(by)[bx]) join.block(bx, by);
  });
}

}  // namespace mixrig::render::cpu
