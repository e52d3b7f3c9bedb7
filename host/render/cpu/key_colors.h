// SPDX-License-Identifier: Apache-2.0
// Pass key: colours of people and room around a block, and the vote of a pixel's colour.
#pragma once

#include <algorithm>

#include "host/render/cpu/key.h"

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
  float w = 0;  ///< mean of the foreground, 1/m
};

/// Calls visit(neighbour) for the blocks within `radius` of (bx, by), itself among them.
template <typename Scratch, typename Visit>
void around(Scratch& scratch, int bx, int by, int radius, Visit&& visit) {
  const Size size = scratch.blocks_size;
  for (int y = std::max(0, by - radius); y <= std::min(size.height - 1, by + radius); ++y)
    for (int x = std::max(0, bx - radius); x <= std::min(size.width - 1, bx + radius); ++x)
      visit(scratch.at(x, y));
}

/// Over the sampled blocks within `radius`.
NearColors colors_around(const KeyScratch& scratch, int bx, int by, int radius);

/// Log odds of foreground by the colour of a pixel, within +-kColorVoteCap. README.md, "key".
float color_vote(const KeyInput& input, const NearColors& near, int x, int y);

}  // namespace mixrig::render::cpu
