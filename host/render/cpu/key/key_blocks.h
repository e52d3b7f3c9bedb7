// SPDX-License-Identifier: Apache-2.0
// Pass key: what blocks of kBlockPx x kBlockPx pixels hold, and what is done in them.
#pragma once

#include <algorithm>
#include <vector>

#include "hal/base/image.h"
#include "host/render/contract/constants.h"

namespace mixrig::render::cpu {

/// Pixels of a row or column of blocks.
inline int block_begin(int b) { return b * kBlockPx; }
inline int block_end(int b, int size) { return std::min(size, (b + 1) * kBlockPx); }

/// A byte a block; flags are 0 and 1.
struct BlockPlanes {
  explicit BlockPlanes(Size blocks);
  using Plane = Image<std::uint8_t>;

  Plane foreground;      ///< pixels
  Plane others;          ///< any pixel that is not foreground
  Plane mirrored;        ///< pixels that show what a mirror shows
  Plane unknown, doubt;  ///< any pixel without depth; any measured where the background has none
  Plane band, near;      ///< within one block of a border, three of foreground
  Plane decided;         ///< votes decide
  Plane decided1, decided2;  ///< within one and two blocks of such
  Plane sampled;             ///< sums of colours are needed

  /// Of the states of block (bx, by), whose image is padded with background to whole blocks;
  /// `pixels` counts without.
  void count(const Image<std::uint8_t>& state, int bx, int by, int pixels);
  /// Background, in `state` too, are: foreground too small to be a person, within 5x5 blocks, and
  /// what is unknown beside what a mirror shows. `tof_px`: pixels that one of the ToF camera
  /// covers.
  void drop_speckles(float tof_px, Image<std::uint8_t>& state);
  /// The band and what follows from it. `room`: colours of the background are needed too.
  void find_band(bool room);
  /// Whether a block and all around it are foreground alone; after find_band().
  bool is_deep(int x, int y) const { return foreground.row(y)[x] > 0 && !band.row(y)[x]; }

 private:
  Plane any_, rows_;
  Image<std::uint16_t> sum_, mirrored_sum_, row_sum_;
  void end_mirrors(Image<std::uint8_t>& state);
  void replace(int bx, int by, std::uint8_t from, Image<std::uint8_t>& state) const;
};

/// Calls visit(begin, end) for runs of at most `most` of 0 .. width - 1 where flags are not 0.
template <typename Visit>
void block_runs(const std::uint8_t* flags, int width, int most, Visit&& visit) {
  for (int b = 0; b < width; ++b) {
    const int begin = b;
    while (b < width && b - begin < most && flags[b]) ++b;
    if (b == begin) continue;
    visit(begin, b);
    --b;  // the block that ended the run may begin another
  }
}

}  // namespace mixrig::render::cpu
