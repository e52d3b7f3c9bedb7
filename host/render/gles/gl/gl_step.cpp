// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/gl_step.h"

#include "host/render/contract/constants.h"

namespace mixrig::render::gles {
namespace {

constexpr int kBlocksUnit = 13;       // of shaders/blocks.vert
constexpr int kVerticesOfABlock = 6;  // two triangles

void prepare(const Target& target, const Program& program,
             std::initializer_list<const Texture*> inputs) {
  bind(target);
  program.use();
  int unit = 0;
  for (const Texture* input : inputs) {
    if (input) bind(unit, *input);
    ++unit;
  }
}

}  // namespace

Result<Step> make_step(const char* fragment_stage, std::initializer_list<const Texture*> outputs,
                       const Texture* depth) {
  Step step;
  MIXRIG_ASSIGN(step.program, make_program("fullscreen.vert", fragment_stage));
  MIXRIG_ASSIGN(step.target, make_target(outputs, depth));
  return step;
}

Size blocks_of(Size picture) {
  return {(picture.width + kBlockPx - 1) / kBlockPx, (picture.height + kBlockPx - 1) / kBlockPx};
}

Result<Step> make_block_step(const char* fragment_stage,
                             std::initializer_list<const Texture*> outputs, int wanted_flags,
                             int pitch_px) {
  Step step;
  MIXRIG_ASSIGN(step.target, make_target(outputs));
  MIXRIG_ASSIGN(step.program,
                make_block_program(fragment_stage, step.target.size, wanted_flags, pitch_px));
  return step;
}

Result<Program> make_block_program(const char* fragment_stage, Size target, int wanted_flags,
                                   int pitch_px) {
  MIXRIG_ASSIGN(Program program, make_program("blocks.vert", fragment_stage));
  program.set("wanted_flags", wanted_flags);
  program.set("clip_of_block",
              2.0F * static_cast<float>(pitch_px) / glm::vec2(target.width, target.height));
  return program;
}

void run(const Step& step, std::initializer_list<const Texture*> inputs) {
  run_into(step.target, step.program, inputs);
}

void run_into(const Target& target, const Program& program,
              std::initializer_list<const Texture*> inputs) {
  prepare(target, program, inputs);
  drop_content(target);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void run_over(const Step& step, std::initializer_list<const Texture*> inputs) {
  prepare(step.target, step.program, inputs);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void run_blocks(const Step& step, const Texture& blocks,
                std::initializer_list<const Texture*> inputs) {
  run_blocks_into(step.target, step.program, blocks, inputs);
}

void run_blocks_into(const Target& target, const Program& program, const Texture& blocks,
                     std::initializer_list<const Texture*> inputs) {
  prepare(target, program, inputs);
  bind(kBlocksUnit, blocks);
  glDrawArrays(GL_TRIANGLES, 0, kVerticesOfABlock * static_cast<GLsizei>(blocks.size.area()));
}

}  // namespace mixrig::render::gles
