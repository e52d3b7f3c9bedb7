// SPDX-License-Identifier: Apache-2.0
// Pass virtual: resolves the covered samples of a pixel.
#pragma once

#include "host/render/cpu/virtual/virtual.h"

namespace mixrig::render::cpu {

/// Writes pixel (x, y) of `layer` from its samples, which start in row `sample_row` of the scratch.
void resolve(const FrameParams& params, const VirtualScratch& scratch, int x, int y, int sample_row,
             VirtualLayer& layer);

}  // namespace mixrig::render::cpu
