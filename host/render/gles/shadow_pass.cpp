// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/shadow_pass.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/render/gles/gl_convention.h"

namespace mixrig::render::gles {

Result<ShadowPass> ShadowPass::create() {
  ShadowPass pass;
  MIXRIG_ASSIGN(pass.program_, make_program("shadow.vert", "shadow.frag"));
  pass.clip_from_object_ = pass.program_.location("clip_from_object");
  return pass;
}

Result<void> ShadowPass::allocate(int size_texel, std::size_t lamps) {
  if (size_texel == size_texel_ && lamps == targets_.size()) return {};
  size_texel_ = size_texel;
  GLuint name = 0;
  glGenTextures(1, &name);
  maps_ = TextureHandle(name);
  glBindTexture(GL_TEXTURE_2D_ARRAY, name);
  glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_DEPTH_COMPONENT32F, size_texel, size_texel,
                 static_cast<GLsizei>(lamps));
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  targets_.clear();
  for (std::size_t i = 0; i < lamps; ++i) {
    glGenFramebuffers(1, &name);
    targets_.emplace_back(name);
    glBindFramebuffer(GL_FRAMEBUFFER, name);
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, maps_.get(), 0,
                              static_cast<GLint>(i));
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      return Error{ErrorCode::kUnsupported,
                   fmt::format("the OpenGL ES driver cannot draw {} shadow maps of {} texels: use "
                               "--backend cpu or fewer lamps",
                               lamps, size_texel)};
  }
  return {};
}

Result<void> ShadowPass::draw(const FrameParams& params, const std::vector<GpuMesh>& meshes) {
  int size_texel = 0;
  for (const LampParams& lamp : params.lamps)
    size_texel = std::max(size_texel, lamp.map_size_texel);
  if (size_texel == 0) return {};
  MIXRIG_TRY(allocate(size_texel, params.lamps.size()));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glClearDepthf(0);
  glViewport(0, 0, size_texel, size_texel);
  program_.use();
  for (std::size_t i = 0; i < params.lamps.size(); ++i) {
    const LampParams& lamp = params.lamps[i];
    if (lamp.map_size_texel == 0) continue;
    const glm::mat4 clip_from_lamp =
        clip_from_camera({glm::vec2(lamp.map_focal_texel), glm::vec2(lamp.map_center_texel)},
                         {size_texel, size_texel});
    glBindFramebuffer(GL_FRAMEBUFFER, targets_[i].get());
    glClear(GL_DEPTH_BUFFER_BIT);
    for (std::size_t k = 0; k < params.draws.size(); ++k) {
      if (!params.draws[k].casts_shadow) continue;
      const auto object = static_cast<std::size_t>(params.draws[k].object);
      set_uniform(clip_from_object_, clip_from_lamp * params.lamp_from_object[i][object]);
      meshes[k].draw();
    }
  }
  glDisable(GL_DEPTH_TEST);
  return {};
}

}  // namespace mixrig::render::gles
