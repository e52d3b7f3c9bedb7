// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "host/render/cpu/key_colors.h"
#include "host/render/cpu/key_depth.h"
#include "host/render/cpu/simd.h"
#include "host/render/cpu/warp.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kUnknown = static_cast<std::uint8_t>(PixelState::kUnknown);
constexpr auto kBackground = static_cast<std::uint8_t>(PixelState::kBackground);
constexpr auto kForeground = static_cast<std::uint8_t>(PixelState::kForeground);
constexpr auto kDoubt = static_cast<std::uint8_t>(PixelState::kEdge);

void classify_row(const float* w, const float* limit_w, int width, std::uint8_t* state) {
  for (int x = 0; x < width; ++x) {
    const float limit = limit_w[x];
    const bool known = w[x] > 0, learned = (limit > 0) & (limit < kNoLimitW);
    const std::uint8_t behind = learned ? kBackground : kDoubt;
    const std::uint8_t measured = w[x] > std::abs(limit) ? kForeground : behind;
    state[x] = known ? measured : kUnknown;
  }
}

/// A row without a background: what lies over the volume's floor is foreground.
void classify_over_floor(const KeyInput& input, const float* w, int y, int width,
                         std::uint8_t* state) {
  constexpr int kRun = 256;
  const PinholeParams& view = input.tables.warp.view;
  const float ray_y = (static_cast<float>(y) - view.center_px.y) / view.focal_px.y;
  std::array<float, kRun> limit_w;
  for (int x0 = 0; x0 < width; x0 += kRun) {
    const int count = std::min(kRun, width - x0);
    for (int i = 0; i < count; ++i) {
      const float ray_x = (static_cast<float>(x0 + i) - view.center_px.x) / view.focal_px.x;
      limit_w[static_cast<std::size_t>(i)] = volume_limit_w(input.params, {ray_x, ray_y, 1});
    }
    classify_row(w + x0, limit_w.data(), count, state + x0);
  }
}

/// Foreground outside the capture box becomes background.
void crop_row(const KeyInput& input, const float* w, int y, int width, std::uint8_t* state) {
  const PinholeParams& view = input.tables.warp.view;
  const KeyPassParams& p = input.params;
  for (int x = 0; x < width; ++x) {
    if (state[x] != kForeground && state[x] != kDoubt) continue;
    const glm::vec2 ray = (glm::vec2(x, y) - view.center_px) / view.focal_px;
    const glm::vec3 world = transform(p.world_from_camera, glm::vec3(ray, 1) / w[x]);
    if (glm::any(glm::lessThan(world, p.crop_min_m)) ||
        glm::any(glm::greaterThan(world, p.crop_max_m)))
      state[x] = kBackground;
  }
}

/// Counts eight states at once: foreground is binary 10, doubt 11, unknown 00.
void count_row(const std::uint8_t* states, Block& block) {
  constexpr std::uint64_t kOnes = 0x0101010101010101U;
  const auto eight = load<std::uint64_t>(states);
  const std::uint64_t high = (eight >> 1) & kOnes, low = eight & kOnes;
  block.foreground += std::popcount(high & ~low);
  block.doubt |= (high & low) != 0;
  block.unknown |= ((high | low) ^ kOnes) != 0;
}

/// The state's image is padded with kBackground to whole blocks; `pixels` counts without.
void count_block(const Image<std::uint8_t>& state, int bx, int by, int pixels, Block& block) {
  block = {};
  for (int y = block_begin(by); y < block_begin(by + 1); ++y)
    count_row(state.row(y) + block_begin(bx), block);
  block.others = block.foreground < pixels;
}

/// Sums of depth and colour over a block.
void sample_block(const KeyInput& input, const Image<float>& view_w,
                  const Image<std::uint8_t>& state, int bx, int by, Block& block) {
  const Size size = input.tables.view_size;
  const bool room = input.needs_room();
  for (int y = block_begin(by); y < block_end(by, size.height); ++y)
    for (int x = block_begin(bx); x < block_end(bx, size.width); ++x) {
      const std::uint8_t s = state.row(y)[x];
      if (room && s == kBackground) block.room.add(linear(input.plate.row(y)[x]));
      if (s != kForeground) continue;
      const float w = view_w.row(y)[x];
      block.w_sum += w;
      if (!from_cut_cell(w)) block.people.add(linear(input.plate.row(y)[x]));
    }
}

/// Foreground too small to be a person becomes background.
void drop_speckles(float footprint_px, KeyScratch& scratch) {
  const float least = kSpeckleTofPx * footprint_px * footprint_px;
  const Size size = scratch.blocks_size;
  for (int by = 0; by < size.height; ++by)
    for (int bx = 0; bx < size.width; ++bx) {
      int sum = 0;
      if (scratch.at(bx, by).foreground > 0)
        around(scratch, bx, by, kSpeckleBlocks, [&](const Block& b) { sum += b.foreground; });
      scratch.speckle_sum[static_cast<std::size_t>(by * size.width + bx)] = sum;
    }
  for (int by = 0; by < size.height; ++by)
    for (int bx = 0; bx < size.width; ++bx) {
      Block& block = scratch.at(bx, by);
      const int sum = scratch.speckle_sum[static_cast<std::size_t>(by * size.width + bx)];
      if (block.foreground == 0 || static_cast<float>(sum) >= least) continue;
      for (int y = block_begin(by); y < block_begin(by + 1); ++y)
        for (int x = block_begin(bx); x < block_begin(bx + 1); ++x)
          if (scratch.state.row(y)[x] == kForeground) scratch.state.row(y)[x] = kBackground;
      block.foreground = 0;
      block.others = true;
    }
}

/// Whether any of the block's pixels may be decided by vote.
bool is_decided(const Block& block) {
  return block.band || block.doubt || (block.near && block.unknown);
}

/// `room`: colours of the background are needed too.
void find_band(bool room, KeyScratch& scratch) {
  const Size size = scratch.blocks_size;
  for (int by = 0; by < size.height; ++by)
    for (int bx = 0; bx < size.width; ++bx) {
      const Block& block = scratch.at(bx, by);
      if (block.foreground == 0) continue;
      around(scratch, bx, by, kNearBlocks, [](Block& b) { b.near = true; });
    }
  // A border runs inside a block, or between two: either way one of the two sees both.
  for (int by = 0; by < size.height; ++by)
    for (int bx = 0; bx < size.width; ++bx) {
      if (!scratch.at(bx, by).near) continue;
      bool any = false, others = false;
      around(scratch, bx, by, kBandBlocks,
             [&](const Block& b) { any |= b.foreground > 0, others |= b.others; });
      scratch.at(bx, by).band = any && others;
    }
  for (int by = 0; by < size.height; ++by)
    for (int bx = 0; bx < size.width; ++bx)
      if (is_decided(scratch.at(bx, by))) {
        around(scratch, bx, by, kNearBlocks,
               [&](Block& b) { b.sampled |= b.foreground > 0 || (room && b.others); });
        for (const int reach : {2, 1, 0})
          around(scratch, bx, by, reach,
                 [&](Block& b) { b.decided_within = std::min(b.decided_within, reach); });
      }
}

/// Offsets of the depth votes' taps along an axis.
constexpr int kDepthTaps = 2 * kDepthTapRadius + 1;
using DepthTaps = std::array<int, kDepthTaps>;

/// Log odds of foreground by the depth around (x, y).
float depth_vote(const Image<std::uint8_t>& state, Size size, const DepthTaps& taps, int x, int y) {
  constexpr std::array<float, 4> kShare = {kUnknownShare, 0, 1, kUnknownShare};  // by PixelState
  DepthTaps columns{};
  for (std::size_t i = 0; i < kDepthTaps; ++i)
    columns[i] = std::clamp(x + taps[i], 0, size.width - 1);
  float sum = 0;
  for (const int tap : taps) {
    const std::uint8_t* row = state.row(std::clamp(y + tap, 0, size.height - 1));
    for (const int column : columns) sum += kShare[row[column]];
  }
  const float balance = 2 * sum / (kDepthTaps * kDepthTaps) - 1;
  return (balance > 0 ? kForegroundWeight : kBackgroundWeight) * balance;
}

DepthTaps taps_of(float footprint_px) {
  DepthTaps taps{};
  for (int i = 0; i < kDepthTaps; ++i)
    taps[static_cast<std::size_t>(i)] = static_cast<int>(
        std::lround(0.5F * footprint_px * static_cast<float>(i - kDepthTapRadius)));
  return taps;
}

/// Colour votes of a block and one pixel around it.
using Votes = std::array<std::array<float, kBlockPx + 2>, kBlockPx + 2>;

void vote_by_color(const KeyInput& input, const NearColors& near, int x0, int y0, Votes& votes) {
  const Size size = input.tables.view_size;
  for (int j = 0; j < kBlockPx + 2; ++j)
    for (int i = 0; i < kBlockPx + 2; ++i) {
      const int x = std::clamp(x0 + i - 1, 0, size.width - 1);
      const int y = std::clamp(y0 + j - 1, 0, size.height - 1);
      votes[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] =
          color_vote(input, near, x, y);
    }
}

float mean_around(const Votes& votes, int i, int j) {
  float sum = 0;
  for (int dj = 0; dj < 3; ++dj)
    for (int di = 0; di < 3; ++di)
      sum += votes[static_cast<std::size_t>(j + dj)][static_cast<std::size_t>(i + di)];
  return sum / 9;
}

/// Whether a pixel is decided by vote rather than by its own depth.
bool is_open(const Block& block, std::uint8_t state) {
  return block.band || state == kDoubt || (block.near && state == kUnknown);
}

void decide_block(const KeyInput& input, KeyScratch& scratch, int bx, int by,
                  Image<std::uint8_t>& matte) {
  Block& block = scratch.at(bx, by);
  const Size size = input.tables.view_size;
  const NearColors near = colors_around(scratch, bx, by, block.band ? kBandBlocks : kNearBlocks);
  block.near_w = near.w;
  block.room_color = near.room.known ? near.room.mean : glm::vec3(-1);
  const DepthTaps taps = taps_of(input.tables.tof_footprint_px);
  const int x0 = block_begin(bx), y0 = block_begin(by);
  Votes votes{};
  if (input.params.color) vote_by_color(input, near, x0, y0, votes);
  for (int y = y0; y < block_end(by, size.height); ++y)
    for (int x = x0; x < block_end(bx, size.width); ++x) {
      const std::uint8_t state = scratch.state.row(y)[x];
      float share = state == kForeground ? 1 : 0;
      if (is_open(block, state)) {
        const float odds =
            mean_around(votes, x - x0, y - y0) + depth_vote(scratch.state, size, taps, x, y);
        share = std::clamp(0.5F + 0.5F * odds, 0.0F, 1.0F);
      }
      matte.row(y)[x] = static_cast<std::uint8_t>(255 * share + 0.5F);
    }
}

/// Foreground that lost the vote has no depth.
void drop_depth(const KeyScratch& scratch, int bx, int by, const Image<std::uint8_t>& matte,
                Image<float>& view_w) {
  for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
    for (int x = block_begin(bx); x < block_end(bx, matte.width()); ++x)
      if (scratch.state.row(y)[x] == kForeground && matte.row(y)[x] == 0) view_w.row(y)[x] = 0;
}

/// Colours of a row of blocks where votes look at them: in blocks to decide and their neighbours.
void draw_colors(const KeyScratch& scratch, int by, Size size, MovingBackground& moving) {
  constexpr int kMostBlocks = MovingBackground::kMostColumns / kBlockPx;
  const auto is_looked_at = [&](int bx) {
    bool any = false;
    around(scratch, bx, by, 1, [&](const Block& b) { any |= is_decided(b); });
    return any;
  };
  for (int bx = 0; bx < scratch.blocks_size.width; ++bx) {
    const int first = bx;
    while (bx < scratch.blocks_size.width && bx - first < kMostBlocks && is_looked_at(bx)) ++bx;
    if (bx == first) continue;
    const int x0 = block_begin(first), width = block_end(bx - 1, size.width) - x0;
    for (int y = block_begin(by); y < block_end(by, size.height); ++y)
      moving.draw_color(x0, y, width);
    --bx;  // the block that ended the run may begin another
  }
}

void fill_block(int bx, int by, std::uint8_t value, Image<std::uint8_t>& matte) {
  for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
    std::fill(matte.row(y) + block_begin(bx), matte.row(y) + block_end(bx, matte.width()), value);
}

}  // namespace

KeyScratch::KeyScratch(Size view_size, float tof_footprint_px)
    : blocks_size{(view_size.width + kBlockPx - 1) / kBlockPx,
                  (view_size.height + kBlockPx - 1) / kBlockPx},
      blocks(blocks_size.area()),
      speckle_sum(blocks_size.area()),
      state({blocks_size.width * kBlockPx, blocks_size.height * kBlockPx}, kBackground),
      refine(view_size, tof_footprint_px) {}

void key(Crew& crew, const KeyInput& input, KeyScratch& scratch, Image<float>& view_w,
         Image<std::uint8_t>& matte) {
  constexpr int kGrain = 4;
  const Size size = input.tables.view_size, blocks = scratch.blocks_size;
  if (input.params.by == KeyBy::kNothing) {
    matte.fill(0);
    scratch.state.fill(kUnknown);
    return;
  }
  crew.rows(blocks.height, kGrain, [&](int begin, int end) {
    for (int y = block_begin(begin); y < block_end(end - 1, size.height); ++y) {
      if (input.params.by == KeyBy::kVolume)
        classify_over_floor(input, view_w.row(y), y, size.width, scratch.state.row(y));
      else
        classify_row(view_w.row(y), input.tables.key_limit_w.row(y), size.width,
                     scratch.state.row(y));
      if (input.params.crop) crop_row(input, view_w.row(y), y, size.width, scratch.state.row(y));
    }
    for (int by = begin; by < end; ++by)
      for (int bx = 0; bx < blocks.width; ++bx) {
        const int pixels = (block_end(bx, size.width) - block_begin(bx)) *
                           (block_end(by, size.height) - block_begin(by));
        count_block(scratch.state, bx, by, pixels, scratch.at(bx, by));
      }
  });
  drop_speckles(input.tables.tof_footprint_px, scratch);
  find_band(input.needs_room(), scratch);
  const auto each_block = [&](auto&& visit) {
    crew.rows(blocks.height, kGrain, [&](int begin, int end) {
      for (int by = begin; by < end; ++by)
        for (int bx = 0; bx < blocks.width; ++bx) visit(bx, by, scratch.at(bx, by));
    });
  };
  if (input.moving)
    crew.rows(blocks.height, kGrain, [&](int begin, int end) {
      for (int by = begin; by < end; ++by) draw_colors(scratch, by, size, *input.moving);
    });
  each_block([&](int bx, int by, Block& block) {
    if (block.sampled) sample_block(input, view_w, scratch.state, bx, by, block);
  });
  each_block([&](int bx, int by, Block& block) {
    if (is_decided(block))
      decide_block(input, scratch, bx, by, matte);
    else
      fill_block(bx, by, block.foreground > 0 ? 255 : 0, matte);
  });
  if (input.params.color && input.params.refine)
    refine(crew, input.plate, scratch, scratch.refine, matte);
  each_block([&](int bx, int by, Block& block) {
    if (is_decided(block)) fill_depth(input, scratch, bx, by, matte, view_w);
  });
  each_block([&](int bx, int by, Block& block) {
    if (is_decided(block)) drop_depth(scratch, bx, by, matte, view_w);
  });
}

}  // namespace mixrig::render::cpu
