// SPDX-License-Identifier: Apache-2.0
// Pass key: blends in the previous matte where the plate has not changed.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/cpu/key/key_blocks.h"
#include "host/render/cpu/plate/srgb.h"

namespace mixrig::render::cpu {

/// Images of the previous frame, of the view's size.
struct FrameBefore {
  const Image<Rgbx16>& plate;
  const Image<std::uint8_t>& matte;
  /// Size of a ToF pixel in the view: background measured this far on all sides gains no people.
  int reach_px = 1;
};

/// Changes the matte of blocks where votes decided; `state` holds the states before votes
/// (docs/method/compositor.md, "key, steady").
void join_before(Crew& crew, const Image<Rgbx16>& plate, const BlockPlanes& blocks,
                 const Image<std::uint8_t>& state, const FrameBefore& before,
                 Image<std::uint8_t>& matte);

}  // namespace mixrig::render::cpu
