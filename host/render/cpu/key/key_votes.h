// SPDX-License-Identifier: Apache-2.0
// Pass key: votes by colour and depth for the pixels of a run of blocks.
#pragma once

#include <array>
#include <vector>

#include "hal/base/image.h"
#include "host/render/cpu/key/key_blocks.h"

namespace mixrig::render::cpu {

struct KeyInput;
struct KeyScratch;
struct NearColors;
class RoomLight;

/// Decides between people and background by votes, for runs of blocks. For one thread.
class KeyVotes {
 public:
  /// Sets the distances of the depth taps. Allocates only if the footprint is larger than ever
  /// before.
  void set_footprint(float tof_footprint_px);
  static constexpr int kMostBlocks = 16;

  /// Writes the matte of blocks bx0 .. bx1 - 1, at most kMostBlocks, of row `by`
  /// (docs/method/compositor.md, "key").
  void decide(const KeyInput& input, int bx0, int bx1, int by, KeyScratch& scratch,
              Image<std::uint8_t>& matte);

 private:
  static constexpr int kRunPx = kMostBlocks * kBlockPx;
  static constexpr int kRows = kBlockPx + 2;  ///< colour votes need one pixel around
  static constexpr int kStride = kRunPx + 2 * 16;
  static constexpr int kVoteStride = 16;  ///< kRows votes, padded to registers
  using Rows = std::array<std::array<float, kStride>, kRows>;
  using Votes = std::array<std::array<float, kVoteStride>, kRows>;
  using Mean = std::array<std::array<float, kBlockPx>, kBlockPx>;

  void load_colors(const KeyInput& input, const RoomLight& light, int bx0, int bx1, int by);
  void load_row(const KeyInput& input, const RoomLight& light, int x0, int width, int by, int j);
  void mean_of_colors(const KeyInput& input, const NearColors& near, int i0, Mean& mean) const;
  using Taps = std::array<int, 2 * kDepthTapRadius + 1>;
  void sum_depths(const Image<std::uint8_t>& state, Size size, int x0, int x1, int y,
                  std::uint8_t* sums);

  Taps taps_{};                        ///< offsets of the depth taps, pixels
  std::vector<std::uint8_t> columns_;  ///< sums of a row's taps along columns
  std::array<std::array<std::uint8_t, kRunPx>, kBlockPx> depths_{};
  // The rows start one pixel left of and above the run.
  Rows r_{}, g_{}, b_{};  ///< plate, linear light
  Rows distance_{};       ///< squared distance to the learned background, over its variance
  Rows log_spread_{};     ///< logarithm of that variance
  Rows most_{};           ///< largest vote; 0: colour does not vote
};

}  // namespace mixrig::render::cpu
