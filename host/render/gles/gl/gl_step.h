// SPDX-License-Identifier: Apache-2.0
// A full-screen draw that computes pictures from pictures; most passes consist of such steps.
#pragma once

#include <initializer_list>

#include "host/render/gles/gl/gl_program.h"
#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

struct Step {
  Program program;
  Target target;
};

/// Makes a step that draws `fragment_stage` over all of `outputs`, optionally with a depth texture.
/// Errors: those of make_program and make_target.
Result<Step> make_step(const char* fragment_stage, std::initializer_list<const Texture*> outputs,
                       const Texture* depth = nullptr);
/// Number of blocks of kBlockPx that cover a picture.
Size blocks_of(Size picture);
/// Makes a step that draws only blocks with one of `wanted_flags` (shaders/blocks.vert); a block is
/// `pitch_px` wide. Errors: those of make_step.
Result<Step> make_block_step(const char* fragment_stage,
                             std::initializer_list<const Texture*> outputs, int wanted_flags,
                             int pitch_px);

/// Makes the program of a block step for targets of this size. Errors: those of make_program.
Result<Program> make_block_program(const char* fragment_stage, Size target, int wanted_flags,
                                   int pitch_px);

/// Draws a step with these inputs on units 0, 1, ...; null leaves a unit as it is. The step writes
/// every pixel: what its target held is dropped.
void run(const Step& step, std::initializer_list<const Texture*> inputs);
/// Draws a step that discards pixels, blends, or is limited by scissors or depth: pixels that it
/// does not write keep what they held.
void run_over(const Step& step, std::initializer_list<const Texture*> inputs);
/// Draws with a step's program into any target, as run() does.
void run_into(const Target& target, const Program& program,
              std::initializer_list<const Texture*> inputs);
/// Draws a block step; `blocks` holds the flags. Other blocks keep what they held.
void run_blocks(const Step& step, const Texture& blocks,
                std::initializer_list<const Texture*> inputs);
/// Draws with the program of a block step into any target, as run_blocks() does.
void run_blocks_into(const Target& target, const Program& program, const Texture& blocks,
                     std::initializer_list<const Texture*> inputs);

}  // namespace mixrig::render::gles
