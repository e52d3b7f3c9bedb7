// SPDX-License-Identifier: Apache-2.0
#include "tests/gl/dropped.h"

#include <array>

#include <GLES3/gl31.h>

namespace {

int dropped = 0;

void fill(GLenum attachment) {
  constexpr float kDepth = 0.625F;
  constexpr std::array<float, 4> kColor = {0.625F, 0.375F, 0.875F, 0.5F};
  if (attachment == GL_DEPTH_ATTACHMENT) return glClearBufferfv(GL_DEPTH, 0, &kDepth);
  const GLenum index = attachment - GL_COLOR_ATTACHMENT0;
  GLint drawn = GL_NONE;
  glGetIntegerv(GL_DRAW_BUFFER0 + index, &drawn);
  if (drawn != GL_NONE) glClearBufferfv(GL_COLOR, static_cast<GLint>(index), kColor.data());
}

}  // namespace

int mixrig::test::dropped_count() { return dropped; }

extern "C" void glInvalidateFramebuffer(GLenum /*target*/, GLsizei count,
                                        const GLenum* attachments) {
  ++dropped;
  const GLboolean scissors = glIsEnabled(GL_SCISSOR_TEST);
  glDisable(GL_SCISSOR_TEST);
  for (GLsizei i = 0; i < count; ++i) fill(attachments[i]);
  if (scissors) glEnable(GL_SCISSOR_TEST);
}
