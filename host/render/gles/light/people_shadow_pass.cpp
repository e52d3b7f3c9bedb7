// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/light/people_shadow_pass.h"

namespace mixrig::render::gles {

Result<PeopleShadowPass> PeopleShadowPass::create(const Tables& tables) {
  PeopleShadowPass pass;
  const Size view = tables.view_size;
  const Size blocks = blocks_of(view);
  pass.w_ = make_texture(blocks, GL_R32F);
  pass.balls_ = make_texture(blocks, GL_RGBA32F);
  MIXRIG_ASSIGN(pass.find_w_, make_step("people_w.frag", {&pass.w_}));
  MIXRIG_ASSIGN(pass.find_balls_, make_step("people_balls.frag", {&pass.balls_}));
  pass.set_view(tables);
  MIXRIG_ASSIGN(pass.program_, make_program("people_shadow.vert", "people_shadow.frag"));
  pass.lamp_from_camera_ = pass.program_.location("lamp_from_camera");
  pass.clip_from_lamp_ = pass.program_.location("clip_from_lamp");
  pass.focal_texel_ = pass.program_.location("focal_texel");
  pass.near_m_ = pass.program_.location("near_m");
  return pass;
}

void PeopleShadowPass::set_view(const Tables& tables) const {
  find_balls_.program.set("focal_px", tables.warp.view.focal_px);
  find_balls_.program.set("center_px", tables.warp.view.center_px);
}

Result<void> PeopleShadowPass::draw(const FrameParams& params, const Texture& matte,
                                    const Texture& visible_w) {
  MIXRIG_TRY(maps_.allocate(params.people_lamps));
  run(find_w_, {&matte, &visible_w});
  run(find_balls_, {&w_});
  for (std::size_t i = 0; i < params.people_lamps.size(); ++i) {
    const LampParams& lamp = params.people_lamps[i];
    if (lamp.map_size_texel == 0) continue;
    maps_.begin(i);
    program_.use();
    bind(0, balls_);
    set_uniform(lamp_from_camera_, lamp.lamp_from_camera);
    set_uniform(clip_from_lamp_, clip_from_lamp(lamp));
    set_uniform(focal_texel_, lamp.map_focal_texel);
    set_uniform(near_m_, lamp.casters_near_m);
    // The border of a map stays empty.
    glEnable(GL_SCISSOR_TEST);
    glScissor(1, 1, lamp.map_size_texel - 2, lamp.map_size_texel - 2);
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(balls_.size.area()));
    glDisable(GL_SCISSOR_TEST);
  }
  glDisable(GL_DEPTH_TEST);
  return {};
}

}  // namespace mixrig::render::gles
