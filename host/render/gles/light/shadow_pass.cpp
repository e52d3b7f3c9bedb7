// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/light/shadow_pass.h"

namespace mixrig::render::gles {

Result<ShadowPass> ShadowPass::create() {
  ShadowPass pass;
  MIXRIG_ASSIGN(pass.program_, make_program("shadow.vert", "shadow.frag"));
  pass.clip_from_object_ = pass.program_.location("clip_from_object");
  return pass;
}

Result<void> ShadowPass::draw(const FrameParams& params, const std::vector<GpuMesh>& meshes) {
  MIXRIG_TRY(maps_.allocate(params.lamps));
  for (std::size_t i = 0; i < params.lamps.size(); ++i) {
    const LampParams& lamp = params.lamps[i];
    if (lamp.map_size_texel == 0) continue;
    maps_.begin(i);
    program_.use();
    for (std::size_t k = 0; k < params.draws.size(); ++k) {
      if (!params.draws[k].casts_shadow) continue;
      const auto object = static_cast<std::size_t>(params.draws[k].object);
      set_uniform(clip_from_object_, clip_from_lamp(lamp) * params.lamp_from_object[i][object]);
      meshes[k].draw();
    }
  }
  glDisable(GL_DEPTH_TEST);
  return {};
}

}  // namespace mixrig::render::gles
