// SPDX-License-Identifier: Apache-2.0
// Pass key, last step: refines the matte along edges of the plate where votes decided.
#pragma once

#include "hal/base/image.h"
#include "hal/base/parallel.h"
#include "host/render/cpu/plate/srgb.h"

namespace mixrig::render::cpu {

struct BlockPlanes;
struct KeyInput;
class RoomLight;

/// Several numbers for each tile: one image row for each number of a row of tiles, so that
/// neighbouring tiles lie side by side. Tiles beyond the picture have memory too.
struct TileNumbers {
  TileNumbers(Size tiles, int numbers);
  float* at(int number, int x, int y) { return values.row(y * numbers + number) + kMargin + x; }
  const float* at(int number, int x, int y) const {
    return values.row(y * numbers + number) + kMargin + x;
  }
  static constexpr int kMargin = 16;
  int numbers;
  Image<float> values;
};

struct RefineScratch {
  RefineScratch(Size view_size, float tof_footprint_px);
  int tile_px;  ///< matte_tile_px
  Size tiles;
  /// Sums over the pixels of tiles near blocks where votes decide: their number n, the matte p, the
  /// colour c (square roots of linear light) and products, in the order n, p, c (3), c p (3), c c
  /// (6: rr, rg, rb, gg, gb, bb).
  static constexpr int kSums = 14;
  TileNumbers sums;
  /// For the window around each tile: the matte as a line of the colour, a . c + b, and means of p
  /// and c p.
  static constexpr int kLine = 8;
  TileNumbers lines;
};

/// Refines the matte of blocks where votes decide by a guided filter: in windows of 5x5 tiles the
/// matte is a line of the plate's colour, fitted to the voted matte by least squares (He, Sun and
/// Tang 2010). Lines are computed once a tile and interpolated (He and Sun 2015). Where a
/// background was learned and people's colour differs from it, a pixel in doubt gets its share of
/// both colours.
void refine(Crew& crew, const KeyInput& input, const BlockPlanes& blocks, const RoomLight& light,
            RefineScratch& scratch, Image<std::uint8_t>& matte);

}  // namespace mixrig::render::cpu
