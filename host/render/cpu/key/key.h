// SPDX-License-Identifier: Apache-2.0
// Pass key: which pixels show people, by depth, and by colour where depth is in doubt.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/render/contract/tone_curve.h"
#include "host/render/cpu/background/background.h"
#include "host/render/cpu/key/key_blocks.h"
#include "host/render/cpu/key/key_votes.h"
#include "host/render/cpu/key/refine.h"
#include "host/render/cpu/key/steady.h"
#include "host/render/cpu/plate/srgb.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Linear light, 0..1.
inline glm::vec3 linear(Rgbx16 p) { return glm::vec3(p.r, p.g, p.b) * (1 / kLinearOne); }

/// Sums over pixels, linear.
struct ColorSums {
  int count = 0;
  glm::vec3 color{0}, square{0};
  void add(const glm::vec3& c) { ++count, color += c, square += c * c; }
  void add(const ColorSums& s) { count += s.count, color += s.color, square += s.square; }
};

/// Sums over a block of kBlockPx x kBlockPx pixels; `sampled` ones of BlockPlanes hold them.
struct Block {
  float w_sum = 0;           ///< over foreground
  float near_w = 0;          ///< where votes decide: mean w of the foreground around
  ColorSums people;          ///< foreground not drawn by a cut cell
  ColorSums room;            ///< background; where its colour was not learned
  glm::vec3 room_color{-1};  ///< where votes decide: mean of the blocks around
};

struct KeyScratch {
  /// For crews of `threads`.
  KeyScratch(Size view_size, float tof_footprint_px, int threads);
  Size blocks_size;
  BlockPlanes planes;
  std::vector<Block> blocks;
  Image<std::uint8_t> state;    ///< PixelState before colour votes; kEdge is doubt
  std::vector<KeyVotes> votes;  ///< of each thread
  RefineScratch refine;
  Block& at(int x, int y) { return blocks[static_cast<std::size_t>(y * blocks_size.width + x)]; }
  const Block& at(int x, int y) const {
    return blocks[static_cast<std::size_t>(y * blocks_size.width + x)];
  }
};

/// Inputs of the pass.
struct KeyInput {
  const Tables& tables;
  const KeyPassParams& params;
  const BackgroundView& background;
  const Image<Rgbx16>& plate;
  ToneCurve tone{};                     ///< of the plate over the learned background
  MovingBackground* moving = nullptr;   ///< draws the colours of `background` that are needed
  const FrameBefore* before = nullptr;  ///< joins the matte; null: nothing is known of before
  bool learned() const { return !background.color.empty(); }
  bool needs_room() const { return params.color && !learned(); }  ///< its colours beside people
};

/// Writes the matte. `view_w` becomes a person's depth where the matte is not 0 (that of the
/// foreground around where it measured none, the nearer of both where the background has no depth),
/// and unknown where foreground lost the vote.
void key(Crew& crew, const KeyInput& input, KeyScratch& scratch, Image<float>& view_w,
         Image<std::uint8_t>& matte);

}  // namespace mixrig::render::cpu
