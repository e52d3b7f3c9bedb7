// SPDX-License-Identifier: Apache-2.0
// Pass key: finds the pixels that show people, by depth, and by colour where depth is in doubt.
#pragma once

#include <vector>

#include "hal/base/parallel.h"
#include "host/render/contract/tone_curve.h"
#include "host/render/cpu/background/background.h"
#include "host/render/cpu/key/key_blocks.h"
#include "host/render/cpu/key/key_votes.h"
#include "host/render/cpu/key/refine.h"
#include "host/render/cpu/key/room_light.h"
#include "host/render/cpu/key/steady.h"
#include "host/render/cpu/plate/srgb.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Linear light of a pixel, 0..1.
inline glm::vec3 linear(Rgbx16 p) { return glm::vec3(p.r, p.g, p.b) * (1 / kLinearOne); }

/// Count, sums and sums of squares of linear colours.
struct ColorSums {
  int count = 0;
  glm::vec3 color{0}, square{0};
  void add(const glm::vec3& c) { ++count, color += c, square += c * c; }
  void add(const ColorSums& s) { count += s.count, color += s.color, square += s.square; }
};

/// Sums over a block of kBlockPx x kBlockPx pixels, computed where BlockPlanes::sampled is set.
struct Block {
  float w_sum = 0;           ///< inverse depths of foreground
  float near_w = 0;          ///< mean w of the foreground around, set where votes decide
  ColorSums people;          ///< foreground that no cut cell drew
  ColorSums room;            ///< background, if its colour was not learned
  glm::vec3 room_color{-1};  ///< mean of the blocks around, set where votes decide
};

struct KeyScratch {
  /// Allocates for crews of `threads`.
  KeyScratch(Size view_size, float tof_footprint_px, int threads);
  Size blocks_size;
  BlockPlanes planes;
  std::vector<Block> blocks;
  Image<std::uint8_t> state;    ///< PixelState before colour votes; kEdge is doubt
  Image<std::uint8_t> alone;    ///< 1 where find_alone() marked a pixel, while a frame is keyed
  std::vector<KeyVotes> votes;  ///< one for each thread
  RefineScratch refine;
  RoomLight room_light;
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
  ToneCurve tone{};                    ///< plate relative to the learned background
  MovingBackground* moving = nullptr;  ///< if not null, draws the colours of `background` on demand
  const FrameBefore* before = nullptr;  ///< previous frame for the steady matte; null: unknown
  bool learned() const { return !background.color.empty(); }
  /// Standard deviation of the learned colours of kLanes pixels in the plate's light; 0 if unknown.
  FloatLanes learned_sigma(int x, int y) const {
    if (background.color_sigma.empty()) return FloatLanes{};
    return tone.gain.g * float_lanes(background.color_sigma.row(y), x, tables.view_size.width);
  }
  /// Compares the room's light around people with the learned one.
  bool finds_light() const { return params.color && learned() && moving == nullptr; }
  /// Estimates the room's colours beside people.
  bool needs_room() const { return params.color && !learned(); }
};

/// Writes the matte. Where the matte is not 0, `view_w` becomes the person's inverse depth:
/// measured, filled from the foreground around, or the nearer of both where the background has no
/// depth. Where foreground lost the vote it becomes unknown.
void key(Crew& crew, const KeyInput& input, KeyScratch& scratch, Image<float>& view_w,
         Image<std::uint8_t>& matte);

}  // namespace mixrig::render::cpu
