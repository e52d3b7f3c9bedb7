// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/map_array.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/render/gles/gl/gl_convention.h"

namespace mixrig::render::gles {

Result<void> MapArray::allocate(const std::vector<LampParams>& lamps) {
  int size_texel = 0;
  for (const LampParams& lamp : lamps) size_texel = std::max(size_texel, lamp.map_size_texel);
  if (size_texel == 0 || (size_texel == size_texel_ && lamps.size() == targets_.size())) return {};
  size_texel_ = size_texel;
  GLuint name = 0;
  glGenTextures(1, &name);
  maps_ = TextureHandle(name);
  glBindTexture(GL_TEXTURE_2D_ARRAY, name);
  glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_DEPTH_COMPONENT32F, size_texel, size_texel,
                 static_cast<GLsizei>(lamps.size()));
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  targets_.clear();
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    glGenFramebuffers(1, &name);
    targets_.emplace_back(name);
    glBindFramebuffer(GL_FRAMEBUFFER, name);
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, maps_.get(), 0,
                              static_cast<GLint>(i));
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      return Error{ErrorCode::kUnsupported,
                   fmt::format("the OpenGL ES driver cannot draw {} shadow maps of {} texels: use "
                               "--backend cpu or fewer lamps",
                               lamps.size(), size_texel)};
  }
  return {};
}

void MapArray::begin(std::size_t lamp) const {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glClearDepthf(0);
  glViewport(0, 0, size_texel_, size_texel_);
  glBindFramebuffer(GL_FRAMEBUFFER, targets_[lamp].get());
  glClear(GL_DEPTH_BUFFER_BIT);
}

glm::mat4 clip_from_lamp(const LampParams& lamp) {
  return clip_from_camera({glm::vec2(lamp.map_focal_texel), glm::vec2(lamp.map_center_texel)},
                          {lamp.map_size_texel, lamp.map_size_texel});
}

}  // namespace mixrig::render::gles
