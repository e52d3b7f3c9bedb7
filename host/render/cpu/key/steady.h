// SPDX-License-Identifier: Apache-2.0
// Pass key: the matte of the frame before, moved with people, joins where the plate stayed alike.
#pragma once

#include <glm/glm.hpp>

#include "hal/base/parallel.h"
#include "host/render/cpu/key/key_blocks.h"
#include "host/render/cpu/plate/srgb.h"

namespace mixrig::render::cpu {

/// The frame before, of the view's size.
struct FrameBefore {
  const Image<Rgbx16>& plate;
  const Image<std::uint8_t>& matte;
  const Image<glm::vec2>& motion_px;  ///< of PeopleMotion, a cell
  int cell_px = 1;
  int reach_px = 1;  ///< of a depth camera's pixel: measured background all around stays
};

/// Changes the matte of blocks where votes decided; `state` is that before votes.
/// docs/method/compositor.md, "Refine".
void join_before(Crew& crew, const Image<Rgbx16>& plate, const BlockPlanes& blocks,
                 const Image<std::uint8_t>& state, const FrameBefore& before,
                 Image<std::uint8_t>& matte);

}  // namespace mixrig::render::cpu
