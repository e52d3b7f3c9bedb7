// SPDX-License-Identifier: Apache-2.0
// Pass virtual: resolves samples to pixels, a register of pixels at a time.
#pragma once

#include "host/render/cpu/virtual/virtual.h"

namespace mixrig::render::cpu {

VirtualScratch::Surface surface_of(const Draw& draw, const Triangle& triangle,
                                   std::uint32_t first_index);

/// Whether resolve_lanes() can handle the mesh.
bool fits_lanes(const MeshView& mesh);

/// Resolves, like resolve(), the kLanes pixels from (x, y) on; the first `done` of them were
/// resolved before and stay. Returns false, and writes nothing, if they show a mesh that does not
/// fit.
bool resolve_lanes(const FrameParams& params, const VirtualScratch& scratch, int x, int y,
                   int sample_row, int done, VirtualLayer& layer);

}  // namespace mixrig::render::cpu
