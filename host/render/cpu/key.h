// SPDX-License-Identifier: Apache-2.0
// Pass key: which pixels show people, by depth, and by colour where depth is in doubt.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/background.h"
#include "host/render/cpu/srgb.h"
#include "host/render/prepare.h"

namespace mixrig::render::cpu {

/// Sums over pixels, linear.
struct ColorSums {
  int count = 0;
  glm::vec3 color{0}, square{0};
  void add(const glm::vec3& c) { ++count, color += c, square += c * c; }
  void add(const ColorSums& s) { count += s.count, color += s.color, square += s.square; }
};

/// What a block of kBlockPx x kBlockPx pixels holds.
struct Block {
  int foreground = 0;               ///< pixels
  bool others = false;              ///< any pixel that is not foreground
  bool unknown = false;             ///< any pixel without depth
  bool doubt = false;               ///< any pixel measured where the background has no depth
  bool band = false, near = false;  ///< within one block of a border, three of foreground
  bool sampled = false;             ///< the sums below are needed
  float w_sum = 0;                  ///< over foreground
  ColorSums people;                 ///< foreground not drawn by a cut cell
  ColorSums room;                   ///< background; where its colour was not learned
  glm::vec3 room_color{-1};         ///< mean of the blocks around that decide_block compared with
};

struct KeyScratch {
  explicit KeyScratch(Size view_size);
  Size blocks_size;
  std::vector<Block> blocks;
  std::vector<int> speckle_sum;  ///< foreground within 5x5 blocks
  Image<std::uint8_t> state;     ///< PixelState before colour votes; kEdge is doubt
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
  glm::vec3 gain{1};                   ///< of the plate over the learned background
  MovingBackground* moving = nullptr;  ///< draws the colours of `background` that are needed
  bool learned() const { return !background.color.empty(); }
  bool needs_room() const { return params.color && !learned(); }  ///< its colours beside people
};

/// Writes the matte. `view_w` becomes a person's depth where the matte is not 0 (that of the
/// foreground around where it measured none), and unknown where foreground lost the vote.
void key(Crew& crew, const KeyInput& input, KeyScratch& scratch, Image<float>& view_w,
         Image<std::uint8_t>& matte);

}  // namespace mixrig::render::cpu
