// SPDX-License-Identifier: Apache-2.0
// An OpenGL ES context for the tests of passes, and functions that read textures.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "host/render/gles/gl/egl_context.h"
#include "host/render/gles/gl/gl_texture.h"
#include "tests/support/image_of.h"

namespace mixrig::test {

/// One context per test suite. Without EGL the tests fail: a machine that builds gles must be able
/// to draw.
class GlTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto made = render::gles::EglContext::create();
    ASSERT_TRUE(made) << made.error().context;
    context_ = std::make_unique<render::gles::EglContext>(std::move(*made));
  }
  static void TearDownTestSuite() { context_.reset(); }
  void TearDown() override { EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR)); }

  static inline std::unique_ptr<render::gles::EglContext> context_;
};

/// All channels of a texture that can be drawn into: floats unchanged, bytes divided by 255.
inline Image<glm::vec4> read(const render::gles::Texture& texture) {
  auto target = render::gles::make_target({&texture});
  EXPECT_TRUE(target);
  Image<glm::vec4> out(texture.size);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target->handle.get());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const bool bytes = texture.internal_format == GL_SRGB8_ALPHA8 ||
                     texture.internal_format == GL_R8 || texture.internal_format == GL_RGB10_A2;
  std::vector<std::uint8_t> raw(4 * texture.size.area());
  std::vector<float> values(raw.size());
  glReadPixels(0, 0, texture.size.width, texture.size.height, GL_RGBA,
               bytes ? GL_UNSIGNED_BYTE : GL_FLOAT,
               bytes ? static_cast<void*>(raw.data()) : values.data());
  for (std::size_t i = 0; bytes && i < raw.size(); ++i) values[i] = float(raw[i]) / 255;
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      const float* p = &values[4 * static_cast<std::size_t>(y * out.width() + x)];
      out.at(x, y) = {p[0], p[1], p[2], p[3]};
    }
  return out;
}

}  // namespace mixrig::test
