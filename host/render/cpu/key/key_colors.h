// SPDX-License-Identifier: Apache-2.0
// Pass key: colours of people and background around a block.
#pragma once

#include "host/render/cpu/key/key.h"

namespace mixrig::render::cpu {

/// A reference colour. `variance` is the mean over the channels.
struct NearColor {
  glm::vec3 mean{0};
  float variance = 0;
  bool known = false;
};

/// Reference colours around a block.
struct NearColors {
  NearColor people, room;
  NearColor deep;  ///< of the nearest block deep inside the foreground
  float w = 0;     ///< mean inverse depth of the foreground, 1/m
};

/// Sums depth and colour over the block (bx, by) and its right neighbour, if they are sampled.
void sample_pair(const KeyInput& input, const Image<float>& view_w, int bx, int by,
                 KeyScratch& scratch);

/// Averages over the sampled blocks within `radius` of (bx, by). `flicker`: least standard
/// deviation of the colours beside camera noise, as a part of their luminance.
NearColors colors_around(const KeyScratch& scratch, int bx, int by, int radius, float flicker);

}  // namespace mixrig::render::cpu
