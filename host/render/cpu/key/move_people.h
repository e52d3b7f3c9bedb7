// SPDX-License-Identifier: Apache-2.0
// Moves people's depth to where they were at the time of the plate, before pass key.
#pragma once

#include "hal/base/parallel.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// Moves foreground of `view_w` (nearer than the limit of the key) by the shift of the cell,
/// `cell_px` pixels wide, that it moves into; places that it leaves become unknown. `before` is
/// working memory of the size of `view_w`.
void move_people(Crew& crew, const Image<float>& limit_w, const Image<glm::vec2>& shift_px,
                 int cell_px, Image<float>& before, Image<float>& view_w);

}  // namespace mixrig::render::cpu
