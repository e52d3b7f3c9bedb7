// SPDX-License-Identifier: Apache-2.0
// Pass key: states of pixels summed up in blocks of kBlockPx x kBlockPx pixels.
#pragma once

#include <algorithm>
#include <vector>

#include "hal/base/image.h"
#include "host/render/contract/constants.h"

namespace mixrig::render::cpu {

/// First pixel, and end, of block b in a row or column.
inline int block_begin(int b) { return b * kBlockPx; }
inline int block_end(int b, int size) { return std::min(size, (b + 1) * kBlockPx); }

/// Images with one byte a block; flags are 0 and 1.
struct BlockPlanes {
  explicit BlockPlanes(Size blocks);
  using Plane = Image<std::uint8_t>;

  Plane foreground;  ///< number of foreground pixels
  Plane others;      ///< flag: some pixel is not foreground
  Plane mirrored;    ///< number of pixels that show a mirror's depth
  /// Flags: some pixel has no depth; some measured pixel has no background depth.
  Plane unknown, doubt;
  Plane band, near;  ///< flags: within one block of a border; within three blocks of foreground
  Plane decided;     ///< flag: votes decide
  Plane decided1, decided2;  ///< flags: within one and two blocks of a decided one
  Plane sampled;             ///< flag: sums of colours are needed

  /// Counts the states of block (bx, by); the image is padded with background to whole blocks, and
  /// `pixels` is the number without padding.
  void count(const Image<std::uint8_t>& state, int bx, int by, int pixels);
  /// Turns into background, in `state` too, foreground that is too small for a person within 5x5
  /// blocks, and unknown pixels beside a mirror. `tof_px`: view pixels that a ToF pixel covers.
  void drop_speckles(float tof_px, Image<std::uint8_t>& state);
  /// Sets the band and the flags that follow from it. `room`: colours of the background are needed
  /// too.
  void find_band(bool room);
  /// Whether a block and its neighbours are all foreground. Call it after find_band().
  bool is_deep(int x, int y) const { return foreground.row(y)[x] > 0 && !band.row(y)[x]; }

 private:
  Plane any_, rows_;
  Image<std::uint16_t> sum_, mirrored_sum_, row_sum_;
  void end_mirrors(Image<std::uint8_t>& state);
  void replace(int bx, int by, std::uint8_t from, Image<std::uint8_t>& state) const;
};

/// Calls visit(begin, end) for runs of nonzero flags among 0 .. width - 1, each at most `most`
/// long.
template <typename Visit>
void block_runs(const std::uint8_t* flags, int width, int most, Visit&& visit) {
  for (int b = 0; b < width; ++b) {
    const int begin = b;
    while (b < width && b - begin < most && flags[b]) ++b;
    if (b == begin) continue;
    visit(begin, b);
    --b;  // the block after a full run may begin another one
  }
}

}  // namespace mixrig::render::cpu
