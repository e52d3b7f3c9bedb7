// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/virtual/edge_pass.h"

namespace mixrig::render::gles {

Result<EdgePass> EdgePass::create(const Tables& tables) {
  EdgePass pass;
  pass.color_ = make_texture(tables.view_size, GL_RGBA16F);
  pass.w_ = make_texture(tables.view_size, GL_R32F);
  MIXRIG_ASSIGN(pass.soften_, make_step("virtual_edges.frag", {&pass.color_, &pass.w_}));
  pass.edge_tap_ = pass.soften_.program.location("edge_tap");
  return pass;
}

void EdgePass::draw(const Rect& rect, float tap, const Texture& sharp_color,
                    const Texture& sharp_w) const {
  bind(soften_.target);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  if (rect.empty()) return;
  soften_.program.use();
  set_uniform(edge_tap_, tap);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
  run_over(soften_, {&sharp_color, &sharp_w});
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace mixrig::render::gles
