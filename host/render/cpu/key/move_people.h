// SPDX-License-Identifier: Apache-2.0
// Before pass key: people's depth is moved to where they were at the time of the plate.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Foreground of `view_w` (before the limit of the key) moves by the shift of the cell, `cell_px`
/// pixels wide, that it moves into; what it leaves is unknown. Uses the memory of `before`, which
/// is as large as `view_w`.
void move_people(Crew& crew, const Image<float>& limit_w, const Image<glm::vec2>& shift_px,
                 int cell_px, Image<float>& before, Image<float>& view_w);

}  // namespace mixrig::render::cpu
