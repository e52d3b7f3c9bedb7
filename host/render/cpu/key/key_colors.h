// SPDX-License-Identifier: Apache-2.0
// Pass key: colours of people and room around a block.
#pragma once

#include "host/render/cpu/key/key.h"

namespace mixrig::render::cpu {

/// What a pixel's colour is compared with. `variance` is the mean over the channels.
struct NearColor {
  glm::vec3 mean{0};
  float variance = 0;
  bool known = false;
};

/// Around a block.
struct NearColors {
  NearColor people, room;
  NearColor deep;  ///< of the nearest block deep inside the foreground
  float w = 0;     ///< mean of the foreground, 1/m
};

/// Sums of depth and colour over the block (bx, by) and the one right of it, for those that are
/// sampled.
void sample_pair(const KeyInput& input, const Image<float>& view_w, int bx, int by,
                 KeyScratch& scratch);

/// Over the sampled blocks within `radius`.
NearColors colors_around(const KeyScratch& scratch, int bx, int by, int radius);

}  // namespace mixrig::render::cpu
