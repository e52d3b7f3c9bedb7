// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/gl_step.h"

namespace mixrig::render::gles {
namespace {

constexpr int kBlocksUnit = 6;        // of shaders/blocks.vert
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

Result<Step> make(const char* vertex_stage, const char* fragment_stage,
                  std::initializer_list<const Texture*> outputs, const Texture* depth = nullptr) {
  Step step;
  MIXRIG_ASSIGN(step.program, make_program(vertex_stage, fragment_stage));
  MIXRIG_ASSIGN(step.target, make_target(outputs, depth));
  return step;
}

}  // namespace

Result<Step> make_step(const char* fragment_stage, std::initializer_list<const Texture*> outputs,
                       const Texture* depth) {
  return make("fullscreen.vert", fragment_stage, outputs, depth);
}

Result<Step> make_block_step(const char* fragment_stage,
                             std::initializer_list<const Texture*> outputs, int wanted_flags,
                             int pitch_px) {
  MIXRIG_ASSIGN(Step step, make("blocks.vert", fragment_stage, outputs));
  const Size size = step.target.size;
  step.program.set("wanted_flags", wanted_flags);
  step.program.set("clip_of_block",
                   2.0F * static_cast<float>(pitch_px) / glm::vec2(size.width, size.height));
  return step;
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
  prepare(step.target, step.program, inputs);
  bind(kBlocksUnit, blocks);
  glDrawArrays(GL_TRIANGLES, 0, kVerticesOfABlock * static_cast<GLsizei>(blocks.size.area()));
}

}  // namespace mixrig::render::gles
