// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/key_colors.h"

#include <algorithm>
#include <cmath>

#include "host/render/cpu/color_lanes.h"

namespace mixrig::render::cpu {
namespace {

/// `flicker`: the least standard deviation is that part of the luminance, plus camera noise.
NearColor mean_of(const ColorSums& sums, float flicker) {
  NearColor out;
  if (sums.count < kBlockPx) return out;
  const float n = static_cast<float>(sums.count);
  out.known = true;
  out.mean = sums.color / n;
  const glm::vec3 variance = sums.square / n - out.mean * out.mean;
  const float floor = kColorNoise + flicker * luminance(out.mean);
  out.variance = std::max(0.0F, (variance.r + variance.g + variance.b) / 3) + floor * floor;
  return out;
}

constexpr auto kSampledForeground = static_cast<std::uint8_t>(PixelState::kForeground);
constexpr auto kSampledBackground = static_cast<std::uint8_t>(PixelState::kBackground);

/// Sums of colours, a column a lane.
struct ColumnSums {
  FloatLanes count{};
  std::array<FloatLanes, 3> color{}, square{};
  void add(const ColorLanes& c, IntLanes where) {
    count += where ? FloatLanes{} + 1 : FloatLanes{};
    const std::array<FloatLanes, 3> channels{c.r, c.g, c.b};
    for (std::size_t k = 0; k < 3; ++k) {
      const FloatLanes one = where ? channels[k] : FloatLanes{};
      color[k] += one, square[k] += one * one;
    }
  }
  void add_lane(int i, ColorSums& to) const {
    to.count += static_cast<int>(count[i]);
    to.color += glm::vec3(color[0][i], color[1][i], color[2][i]);
    to.square += glm::vec3(square[0][i], square[1][i], square[2][i]);
  }
};

struct PairSums {
  FloatLanes w{};
  ColumnSums people, room;
};

/// Sums over the columns x .. x + kLanes - 1 of a row of blocks.
template <bool kRoom>
PairSums column_sums(const KeyInput& input, const Image<float>& view_w,
                     const Image<std::uint8_t>& states, int x, int by) {
  const Size size = input.tables.view_size;
  const FloatLanes last = FloatLanes{} + static_cast<float>(size.width - x);
  const IntLanes inside = lane_numbers() < last;
  PairSums sums;
  for (int y = block_begin(by); y < block_end(by, size.height); ++y) {
    const IntLanes state = byte_lanes(states.row(y), x, states.width());
    const FloatLanes w = float_lanes(view_w.row(y), x, view_w.width());
    const ColorLanes color = color_lanes(input.plate.row(y), x, size.width);
    const IntLanes foreground = (state == kSampledForeground) & inside;
    sums.w += foreground ? w : FloatLanes{};
    sums.people.add(color, foreground & ((std::bit_cast<IntLanes>(w) & 1) == 0));
    if constexpr (kRoom) sums.room.add(color, (state == kSampledBackground) & inside);
  }
  return sums;
}

template <bool kRoom>
void sample_columns(const KeyInput& input, const Image<float>& view_w, int bx, int by,
                    KeyScratch& scratch) {
  const int end = std::min(bx + 2, scratch.blocks_size.width);
  for (int b = bx; b < end; ++b) scratch.at(b, by) = {};
  for (int x = block_begin(bx); x < block_begin(end); x += kLanes) {
    const PairSums sums = column_sums<kRoom>(input, view_w, scratch.state, x, by);
    for (int i = 0; i < kLanes; ++i) {
      const int b = (x + i) / kBlockPx;
      if (b >= end) break;
      Block& block = scratch.at(b, by);
      block.w_sum += sums.w[i];
      sums.people.add_lane(i, block.people);
      if constexpr (kRoom) sums.room.add_lane(i, block.room);
    }
  }
}

}  // namespace

void sample_pair(const KeyInput& input, const Image<float>& view_w, int bx, int by,
                 KeyScratch& scratch) {
  if (input.needs_room())
    sample_columns<true>(input, view_w, bx, by, scratch);
  else
    sample_columns<false>(input, view_w, bx, by, scratch);
}

namespace {

/// Colour of the nearest block around that is deep inside the foreground; of several, the first row
/// by row.
NearColor deep_color(const KeyScratch& scratch, int bx, int by, float flicker) {
  const Size size = scratch.blocks_size;
  NearColor out;
  int nearest = 2 * (kDeepBlocks + 1) * (kDeepBlocks + 1);
  for (int y = std::max(0, by - kDeepBlocks); y <= std::min(size.height - 1, by + kDeepBlocks); ++y)
    for (int x = std::max(0, bx - kDeepBlocks); x <= std::min(size.width - 1, bx + kDeepBlocks);
         ++x) {
      const int away = (x - bx) * (x - bx) + (y - by) * (y - by);
      if (away >= nearest || !scratch.planes.is_deep(x, y)) continue;
      const NearColor color = mean_of(scratch.at(x, y).people, flicker);
      if (color.known) out = color, nearest = away;
    }
  return out;
}

}  // namespace

NearColors colors_around(const KeyScratch& scratch, int bx, int by, int radius, float flicker) {
  NearColors out;
  int foreground = 0;
  ColorSums people, room;
  const Size size = scratch.blocks_size;
  for (int y = std::max(0, by - radius); y <= std::min(size.height - 1, by + radius); ++y)
    for (int x = std::max(0, bx - radius); x <= std::min(size.width - 1, bx + radius); ++x) {
      if (!scratch.planes.sampled.row(y)[x]) continue;
      const Block& b = scratch.at(x, y);
      foreground += scratch.planes.foreground.row(y)[x];
      out.w += b.w_sum;
      people.add(b.people);
      room.add(b.room);
    }
  if (foreground > 0) out.w /= static_cast<float>(foreground);
  out.people = mean_of(people, flicker);
  out.room = mean_of(room, flicker);
  out.deep = deep_color(scratch, bx, by, flicker);
  return out;
}

}  // namespace mixrig::render::cpu
