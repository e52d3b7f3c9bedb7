// SPDX-License-Identifier: Apache-2.0
// Pass virtual, what pixels show, a register of them at a time.
#pragma once

#include "host/render/cpu/virtual/virtual.h"

namespace mixrig::render::cpu {

VirtualScratch::Surface surface_of(const Draw& draw, const Triangle& triangle,
                                   std::uint32_t first_index);

/// Whether resolve_lanes() knows all that a mesh shows.
bool fits_lanes(const MeshView& mesh);

/// As resolve(), for the kLanes pixels from (x, y) on, of which the first `done` were resolved
/// before and stay as they are. False where they show a mesh that does not fit; then nothing is
/// written.
bool resolve_lanes(const FrameParams& params, const VirtualScratch& scratch, int x, int y,
                   int sample_row, int done, VirtualLayer& layer);

}  // namespace mixrig::render::cpu
