// SPDX-License-Identifier: Apache-2.0
// Pass key: how the light of the room around people differs from the learned one.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/cpu/color_lanes.h"
#include "host/render/cpu/key/key_blocks.h"

namespace mixrig::render::cpu {

struct KeyInput;

/// Light of the room in the plate over the learned light under the frame's tone curve, for each
/// channel: people shade the floor beside them, and a camera's tones depend on the place in the
/// picture. How much the room's colour still varies about that light is measured too. For a still
/// camera with learned colours; else 1. Rows of blocks may be visited in parallel.
class RoomLight {
 public:
  explicit RoomLight(Size blocks);
  /// Compares plate and learned colours in row `by` of blocks near votes, where depth shows
  /// nothing but the room.
  void compare(const KeyInput& input, const BlockPlanes& planes, const Image<std::uint8_t>& state,
               int by);
  /// Averages what compare() found around each block of row `by` near votes; call it after
  /// compare() of all rows.
  void average(const BlockPlanes& planes, int by);
  /// Light at the kLanes pixels from x on in row `by` of blocks; x is at least -1.
  ColorLanes at(int x, int by) const { return {lanes(0, x, by), lanes(1, x, by), lanes(2, x, by)}; }
  /// Standard deviation of the room's colour about that light, as a part of its luminance.
  FloatLanes flicker(int x, int by) const { return lanes(3, x, by); }

 private:
  static constexpr int kPlanes = 4, kMargin = 16;
  FloatLanes lanes(int plane, int x, int by) const {
    return load<FloatLanes>(columns_.row(kPlanes * by + plane) + kMargin + x);
  }
  /// Light of the blocks around, and flicker().
  glm::vec4 around(int bx, int by) const;

  Image<glm::vec4> found_;  ///< of each block: light and squared change within it, or 0
  Image<float> columns_;    ///< light and flicker of each column of pixels; a row a plane
};

}  // namespace mixrig::render::cpu
