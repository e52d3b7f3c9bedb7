// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/steady.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/contract/compositor.h"
#include "host/render/frame/people_motion.h"

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

/// For each pixel of a block, the share of the previous matte by likeness of 3x3 pixels, and that
/// matte.
struct BlockBefore {
  std::array<std::array<float, kBlockPx>, kBlockPx> share{}, matte{};
};

/// Pixels of a row from x0 - from on; beyond its ends the end pixels repeat.
using Row = std::array<Rgbx16, kWide>;
Row row_of(const Rgbx16* row, int x0, int from, int last_x) {
  Row out;
  if (x0 >= 0 && x0 + kWide <= last_x + 1 && x0 - from >= 0 && x0 - from + kWide <= last_x + 1) {
    std::copy_n(row + x0 - from, kWide, out.begin());
    return out;
  }
  for (int i = 0; i < kWide; ++i)
    out[static_cast<std::size_t>(i)] =
        row[std::clamp(std::clamp(x0 + i, 0, last_x) - from, 0, last_x)];
  return out;
}

/// What the previous matte may do: change the matte either way, only take people away, or only add
/// people.
enum class Joins { kAll, kRoom, kPeople };

/// Blends the previous matte into the matte of a frame.
struct Join {
  const Image<Rgbx16>& plate;
  const Image<std::uint8_t>& state;
  const FrameBefore& before;
  Image<std::uint8_t>& matte;

  void block(int bx, int by) const;
  bool changes(int x0, int y0, glm::ivec2 from, Joins joins) const;
  void compare(int x0, int y0, glm::ivec2 from, Joins joins, BlockBefore& out) const;
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

/// Whether blending from `from` pixels away would change the matte of the block in a permitted way.
bool Join::changes(int x0, int y0, glm::ivec2 from, Joins joins) const {
  const int last_x = matte.width() - 1, last_y = matte.height() - 1;
  bool higher = false, lower = false;
  for (int y = y0; y < std::min(y0 + kBlockPx, last_y + 1); ++y) {
    const std::uint8_t* then = before.matte.row(std::clamp(y - from.y, 0, last_y));
    for (int x = x0; x < std::min(x0 + kBlockPx, last_x + 1); ++x) {
      const int off = then[std::clamp(x - from.x, 0, last_x)] - matte.row(y)[x];
      higher |= off > 0, lower |= off < 0;
    }
  }
  return (higher && joins != Joins::kRoom) || (lower && joins != Joins::kPeople);
}

/// Compares a block with the previous frame `from` pixels away. Beyond the picture its border
/// repeats.
void Join::compare(int x0, int y0, glm::ivec2 from, Joins joins, BlockBefore& out) const {
  // The roots of three channels differ by about sqrt(6) / 2 times (sum |a - b|) / sqrt(sum of the
  // six values).
  constexpr float kScale = 255.0F * 1.2247449F / 27;
  const float scale = kScale / std::sqrt(static_cast<float>(kLinearOne));
  const int last_x = plate.width() - 1, last_y = plate.height() - 1;
  std::array<std::array<float, kWide>, kWide> d;
  for (int j = 0; j < kWide; ++j) {
    const int y = std::clamp(y0 + j - 1, 0, last_y);
    const Row now = row_of(plate.row(y), x0 - 1, 0, last_x);
    const Row then =
        row_of(before.plate.row(std::clamp(y - from.y, 0, last_y)), x0 - 1, from.x, last_x);
    for (std::size_t i = 0; i < kWide; ++i)
      d[static_cast<std::size_t>(j)][i] = difference(now[i], then[i]);
  }
  for (int y = y0; y < std::min(y0 + kBlockPx, last_y + 1); ++y)
    for (int x = x0; x < std::min(x0 + kBlockPx, last_x + 1); ++x) {
      const auto j = static_cast<std::size_t>(y - y0), i = static_cast<std::size_t>(x - x0);
      float sum = 0;
      for (std::size_t dj = 0; dj < 3; ++dj)
        for (std::size_t di = 0; di < 3; ++di) sum += d[j + dj][i + di];
      const float off = scale * sum / kAlike, share = share_by(off * off);
      if (share <= out.share[j][i]) continue;
      const std::uint8_t now = matte.row(y)[x];
      const std::uint8_t then =
          before.matte.row(std::clamp(y - from.y, 0, last_y))[std::clamp(x - from.x, 0, last_x)];
      if ((joins == Joins::kRoom && then > now) || (joins == Joins::kPeople && then <= now))
        continue;
      if (then > now && !may_be_people(x, y)) continue;
      out.share[j][i] = share;
      out.matte[j][i] = static_cast<float>(then);
    }
}

void Join::block(int bx, int by) const {
  const int x0 = block_begin(bx), y0 = block_begin(by);
  const int cell_x = std::min((x0 + kBlockPx / 2) / before.cell_px, before.motion_px.width() - 1);
  const int cell_y = std::min((y0 + kBlockPx / 2) / before.cell_px, before.motion_px.height() - 1);
  const glm::ivec2 moved(glm::floor(before.motion_px.row(cell_y)[cell_x] + 0.5F));
  const bool moves = moved != glm::ivec2(0);
  const bool people = moves && changes(x0, y0, moved, Joins::kPeople);
  const Joins in_place = moves ? Joins::kRoom : Joins::kAll;
  if (!people && !changes(x0, y0, glm::ivec2(0), in_place)) return;
  BlockBefore found;
  compare(x0, y0, glm::ivec2(0), in_place, found);
  if (people) compare(x0, y0, moved, Joins::kPeople, found);
  for (int y = y0; y < block_end(by, matte.height()); ++y)
    for (int x = x0; x < block_end(bx, matte.width()); ++x) {
      const auto j = static_cast<std::size_t>(y - y0), i = static_cast<std::size_t>(x - x0);
      const auto voted = static_cast<float>(matte.row(y)[x]);
      matte.row(y)[x] =
          static_cast<std::uint8_t>(voted + found.share[j][i] * (found.matte[j][i] - voted) + 0.5F);
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
