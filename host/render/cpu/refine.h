// SPDX-License-Identifier: Apache-2.0
// Pass key, last step: the matte follows the edges of the plate where votes decided.
#pragma once

#include <array>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/parallel.h"
#include "host/render/cpu/srgb.h"

namespace mixrig::render::cpu {

struct KeyScratch;

/// Sums over the pixels of a tile: their number, the matte p, the colour c (square roots of linear
/// light) and their products: n, p, c (3), c p (3), c c (6: rr, rg, rb, gg, gb, bb).
using MatteSums = std::array<float, 14>;
/// The matte as a line of the colour: a . c + b.
using MatteLine = std::array<float, 4>;

struct RefineScratch {
  RefineScratch(Size view_size, float tof_footprint_px);
  int tile_px;  ///< matte_tile_px
  Size tiles;
  std::vector<MatteSums> sums;   ///< of tiles near blocks where votes decide
  std::vector<MatteLine> lines;  ///< of the window around each of them
};

/// Refines the matte of blocks where votes decide by a guided filter: in windows of 5x5 tiles the
/// matte is a line of the plate's colour, fitted to the voted matte by least squares (He, Sun and
/// Tang 2010); lines are found once a tile and interpolated (He and Sun 2015).
void refine(Crew& crew, const Image<Rgbx16>& plate, const KeyScratch& key, RefineScratch& scratch,
            Image<std::uint8_t>& matte);

}  // namespace mixrig::render::cpu
