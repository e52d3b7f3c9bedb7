// SPDX-License-Identifier: Apache-2.0
// Pass virtual: makes edges of objects as wide as those of the plate.
#pragma once

#include "host/render/cpu/virtual/virtual.h"

namespace mixrig::render::cpu {

/// Filters the layer's coverage: a pixel takes `tap` of each of the four pixels beside it and keeps
/// the rest, but none changes its side of kVirtualShare: layers stay as they are. A pixel that only
/// the filter covers shows the surface of the one beside it that is covered most. Call it after
/// draw_virtual(), before the layer is shaded.
void soften_edges(Crew& crew, float tap, VirtualScratch& scratch, VirtualLayer& layer);

}  // namespace mixrig::render::cpu
