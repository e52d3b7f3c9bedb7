// SPDX-License-Identifier: Apache-2.0
// One draw that computes pictures from pictures: what most passes are made of.
#pragma once

#include <initializer_list>

#include "host/render/gles/gl/gl_program.h"
#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

struct Step {
  Program program;
  Target target;
};

/// Draws `fragment_stage` over all of `outputs`, with a depth texture or none. Errors: as
/// make_program and make_target.
Result<Step> make_step(const char* fragment_stage, std::initializer_list<const Texture*> outputs,
                       const Texture* depth = nullptr);
/// Draws only blocks with some flags (shaders/blocks.vert); a block is `pitch_px` wide.
Result<Step> make_block_step(const char* fragment_stage,
                             std::initializer_list<const Texture*> outputs, int wanted_flags,
                             int pitch_px);

/// Draws a step with these inputs on units 0, 1, ...; null leaves a unit as it is.
void run(const Step& step, std::initializer_list<const Texture*> inputs);
/// The same into another target than the step's own.
void run_into(const Target& target, const Step& step, std::initializer_list<const Texture*> inputs);
/// The same for a block step; `blocks` holds the flags.
void run_blocks(const Step& step, const Texture& blocks,
                std::initializer_list<const Texture*> inputs);

}  // namespace mixrig::render::gles
