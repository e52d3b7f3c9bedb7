// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/mix/motion_pass.h"

namespace mixrig::render::gles {

Result<MotionPass> MotionPass::create(const Tables& tables) {
  MotionPass pass;
  pass.color_ = make_texture(tables.view_size, GL_RGBA16F);
  pass.w_ = make_texture(tables.view_size, GL_R32F);
  MIXRIG_ASSIGN(pass.step_, make_step("motion.frag", {&pass.color_, &pass.w_}));
  const Program& program = pass.step_.program;
  pass.turn_rad_ = program.location("turn_rad"), pass.shift_m_ = program.location("shift_m");
  pass.focal_px_ = program.location("focal_px"), pass.center_px_ = program.location("center_px");
  pass.nearest_w_ = program.location("nearest_w");
  return pass;
}

void MotionPass::draw(const MotionParams& params, const Texture& virtual_color,
                      const Texture& virtual_w) const {
  bind(step_.target);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  step_.program.use();
  set_uniform(turn_rad_, params.motion.turn_rad);
  set_uniform(shift_m_, params.motion.shift_m);
  set_uniform(focal_px_, params.focal_px);
  set_uniform(center_px_, params.center_px);
  set_uniform(nearest_w_, params.nearest_w);
  const Rect& r = params.rect;
  glEnable(GL_SCISSOR_TEST);
  glScissor(r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0);
  run_over(step_, {&virtual_color, &virtual_w});
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace mixrig::render::gles
