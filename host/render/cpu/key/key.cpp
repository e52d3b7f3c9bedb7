// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/key.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/cpu/key/key_colors.h"
#include "host/render/cpu/key/key_depth.h"
#include "host/render/cpu/key/key_votes.h"

namespace mixrig::render::cpu {
namespace {

constexpr auto kUnknown = static_cast<std::uint8_t>(PixelState::kUnknown);
constexpr auto kBackground = static_cast<std::uint8_t>(PixelState::kBackground);
constexpr auto kForeground = static_cast<std::uint8_t>(PixelState::kForeground);
constexpr auto kDoubt = static_cast<std::uint8_t>(PixelState::kEdge);

/// Classifies a row by depth. Returns whether a pixel shows a mirror's depth.
bool classify_row(const float* w, const float* limit_w, const float* behind_w, int width,
                  std::uint8_t* state) {
  int mirrored = 0;
  for (int x = 0; x < width; ++x) {
    const float limit = limit_w[x];
    const bool known = w[x] > 0, learned = (limit > 0) & (limit < kNoLimitW);
    const bool mirror = known & (w[x] < behind_w[x]);
    const std::uint8_t behind = learned | mirror ? kBackground : kDoubt;
    const std::uint8_t measured = w[x] > std::abs(limit) ? kForeground : behind;
    state[x] = known ? measured : kUnknown;
    mirrored |= mirror;
  }
  return mirrored != 0;
}

/// Classifies a row without a background: what lies over the volume's floor is foreground.
void classify_over_floor(const KeyInput& input, const float* w, int y, int width,
                         std::uint8_t* state) {
  constexpr int kRun = 256;
  const PinholeParams& view = input.tables.warp.view;
  const float ray_y = (static_cast<float>(y) - view.center_px.y) / view.focal_px.y;
  std::array<float, kRun> limit_w, behind_w{};
  for (int x0 = 0; x0 < width; x0 += kRun) {
    const int count = std::min(kRun, width - x0);
    for (int i = 0; i < count; ++i) {
      const float ray_x = (static_cast<float>(x0 + i) - view.center_px.x) / view.focal_px.x;
      limit_w[static_cast<std::size_t>(i)] = volume_limit_w(input.params, {ray_x, ray_y, 1});
    }
    classify_row(w + x0, limit_w.data(), behind_w.data(), count, state + x0);
  }
}

/// Turns foreground outside the capture box into background.
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

/// Makes the depth of foreground that lost the vote unknown, and clears the marks of find_alone().
void drop_depth(KeyScratch& scratch, int bx, int by, const Image<std::uint8_t>& matte,
                Image<float>& view_w) {
  for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
    for (int x = block_begin(bx); x < block_end(bx, matte.width()); ++x) {
      scratch.alone.row(y)[x] = 0;
      if (scratch.state.row(y)[x] == kForeground && matte.row(y)[x] == 0) view_w.row(y)[x] = 0;
    }
}

/// Draws the colours that a row of blocks needs: those of blocks where votes decide, and of their
/// neighbours.
void draw_colors(const KeyScratch& scratch, int by, Size size, MovingBackground& moving) {
  constexpr int kMostBlocks = MovingBackground::kMostColumns / kBlockPx;
  block_runs(scratch.planes.decided1.row(by), scratch.blocks_size.width, kMostBlocks,
             [&](int begin, int end) {
               const int x0 = block_begin(begin), width = block_end(end - 1, size.width) - x0;
               for (int y = block_begin(by); y < block_end(by, size.height); ++y)
                 moving.draw_color(x0, y, width);
             });
}

/// Writes the matte of a row of blocks where votes do not decide.
void fill_others(const BlockPlanes& planes, int by, Image<std::uint8_t>& matte) {
  const std::uint8_t *decided = planes.decided.row(by), *foreground = planes.foreground.row(by);
  const int width = planes.decided.width();
  for (int bx = 0; bx < width;) {
    const int begin = bx;
    const bool people = foreground[bx] > 0;
    while (bx < width && !decided[bx] && (foreground[bx] > 0) == people) ++bx;
    if (bx == begin) {
      ++bx;
      continue;
    }
    const int x0 = block_begin(begin), x1 = block_end(bx - 1, matte.width());
    for (int y = block_begin(by); y < block_end(by, matte.height()); ++y)
      std::fill(matte.row(y) + x0, matte.row(y) + x1, static_cast<std::uint8_t>(people ? 255 : 0));
  }
}

void sample_blocks(const KeyInput& input, const Image<float>& view_w, int by, KeyScratch& scratch) {
  const std::uint8_t* sampled = scratch.planes.sampled.row(by);
  const int width = scratch.blocks_size.width;
  for (int bx = 0; bx < width; bx += 2)
    if (sampled[bx] || (bx + 1 < width && sampled[bx + 1]))
      sample_pair(input, view_w, bx, by, scratch);
}

/// Counts the pixels with a mirror's depth in a row of blocks.
void count_mirrored(const Image<float>& view_w, const Image<float>& behind_w, int by,
                    KeyScratch& scratch) {
  std::uint8_t* mirrored = scratch.planes.mirrored.row(by);
  for (int y = block_begin(by); y < block_end(by, behind_w.height()); ++y) {
    const float *w = view_w.row(y), *behind = behind_w.row(y);
    for (int x = 0; x < behind_w.width(); ++x)
      mirrored[x / kBlockPx] += w[x] > 0 && w[x] < behind[x];
  }
}

void classify(const KeyInput& input, const Image<float>& view_w, int by, KeyScratch& scratch) {
  const Size size = input.tables.view_size;
  bool mirrored = false;
  for (int y = block_begin(by); y < block_end(by, size.height); ++y) {
    if (input.params.by == KeyBy::kVolume)
      classify_over_floor(input, view_w.row(y), y, size.width, scratch.state.row(y));
    else
      mirrored |= classify_row(view_w.row(y), input.tables.key_limit_w.row(y),
                               input.tables.hole_behind_w.row(y), size.width, scratch.state.row(y));
    if (input.params.crop) crop_row(input, view_w.row(y), y, size.width, scratch.state.row(y));
  }
  const int rows = block_end(by, size.height) - block_begin(by);
  for (int bx = 0; bx < scratch.blocks_size.width; ++bx)
    scratch.planes.count(scratch.state, bx, by,
                         rows * (block_end(bx, size.width) - block_begin(bx)));
  std::fill_n(scratch.planes.mirrored.row(by), scratch.blocks_size.width, std::uint8_t{0});
  if (mirrored) count_mirrored(view_w, input.tables.hole_behind_w, by, scratch);
}

}  // namespace

KeyScratch::KeyScratch(Size view_size, float tof_footprint_px, int threads)
    : blocks_size{(view_size.width + kBlockPx - 1) / kBlockPx,
                  (view_size.height + kBlockPx - 1) / kBlockPx},
      planes(blocks_size),
      blocks(blocks_size.area()),
      state({blocks_size.width * kBlockPx, blocks_size.height * kBlockPx}, kBackground),
      alone(view_size, 0),
      votes(static_cast<std::size_t>(threads)),
      refine(view_size, tof_footprint_px),
      room_light(blocks_size) {
  for (KeyVotes& v : votes) v.set_footprint(tof_footprint_px);
}

void key(Crew& crew, const KeyInput& input, KeyScratch& scratch, Image<float>& view_w,
         Image<std::uint8_t>& matte) {
  constexpr int kGrain = 4;
  const Size blocks = scratch.blocks_size;
  if (input.params.by == KeyBy::kNothing) {
    matte.fill(0);
    scratch.state.fill(kUnknown);
    return;
  }
  const auto each_row = [&](auto&& visit) {
    crew.rows_by_worker(blocks.height, kGrain, [&](int worker, int begin, int end) {
      for (int by = begin; by < end; ++by) visit(by, worker);
    });
  };
  const auto each_decided = [&](auto&& visit) {
    each_row([&](int by, int) {
      for (int bx = 0; bx < blocks.width; ++bx)
        if (scratch.planes.decided.row(by)[bx]) visit(bx, by);
    });
  };
  const float footprint_px = input.tables.tof_footprint_px;
  for (KeyVotes& votes : scratch.votes) votes.set_footprint(footprint_px);
  each_row([&](int by, int) { classify(input, view_w, by, scratch); });
  scratch.planes.drop_speckles(footprint_px * footprint_px, scratch.state);
  scratch.planes.find_band(input.needs_room());
  each_row([&](int by, int) {
    if (input.moving) draw_colors(scratch, by, input.tables.view_size, *input.moving);
    sample_blocks(input, view_w, by, scratch);
    if (input.finds_light()) scratch.room_light.compare(input, scratch.planes, scratch.state, by);
  });
  if (input.finds_light())
    each_row([&](int by, int) { scratch.room_light.average(scratch.planes, by); });
  each_row([&](int by, int worker) {
    fill_others(scratch.planes, by, matte);
    KeyVotes& votes = scratch.votes[static_cast<std::size_t>(worker)];
    block_runs(scratch.planes.decided.row(by), blocks.width, KeyVotes::kMostBlocks,
               [&](int b0, int b1) { votes.decide(input, b0, b1, by, scratch, matte); });
  });
  if (input.params.color && input.params.refine)
    refine(crew, input, scratch.planes, scratch.room_light, scratch.refine, matte);
  if (input.before)
    join_before(crew, input.plate, scratch.planes, scratch.state, *input.before, matte);
  each_decided([&](int bx, int by) { find_alone(input, bx, by, matte, view_w, scratch); });
  each_decided([&](int bx, int by) { fill_depth(input, scratch, bx, by, matte, view_w); });
  each_decided([&](int bx, int by) { drop_depth(scratch, bx, by, matte, view_w); });
}

}  // namespace mixrig::render::cpu
