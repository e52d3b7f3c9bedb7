// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/gl_texture.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <fmt/format.h>

namespace mixrig::render::gles {
namespace {

template <typename T>
void upload_as(const Texture& texture, ImageView<const T> image, GLenum format, GLenum type) {
  assert(image.size == texture.size);
  glBindTexture(GL_TEXTURE_2D, texture.handle.get());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, static_cast<GLint>(image.stride));
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.size.width, image.size.height, format, type,
                  image.data);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

}  // namespace

namespace {

Texture make_name(Size size, GLenum internal_format, Sampling sampling) {
  GLuint name = 0;
  glGenTextures(1, &name);
  Texture texture{TextureHandle(name), size, internal_format};
  glBindTexture(GL_TEXTURE_2D, name);
  const GLint filter = sampling == Sampling::kNearest ? GL_NEAREST : GL_LINEAR;
  const GLint wrap = sampling == Sampling::kRepeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
  return texture;
}

}  // namespace

Texture make_texture(Size size, GLenum internal_format, Sampling sampling) {
  Texture texture = make_name(size, internal_format, sampling);
  glTexStorage2D(GL_TEXTURE_2D, 1, internal_format, size.width, size.height);
  return texture;
}

Texture make_unsized_texture(Size size, GLenum internal_format) {
  return make_name(size, internal_format, Sampling::kNearest);
}

void upload(const Texture& texture, ImageView<const float> image) {
  upload_as(texture, image, GL_RED, GL_FLOAT);
}
void upload(const Texture& texture, ImageView<const glm::vec2> image) {
  upload_as(texture, image, GL_RG, GL_FLOAT);
}
void upload(const Texture& texture, ImageView<const Rgb8> image) {
  upload_as(texture, image, GL_RGB, GL_UNSIGNED_BYTE);
}
void upload(const Texture& texture, ImageView<const Rgbx8> image) {
  upload_as(texture, image, GL_RGBA, GL_UNSIGNED_BYTE);
}
void upload(const Texture& texture, ImageView<const Rgbf> image) {
  upload_as(texture, image, GL_RGB, GL_FLOAT);
}
void upload(const Texture& texture, ImageView<const PackedNormal> image) {
  upload_as(texture, image, GL_RGBA, GL_BYTE);
}
void upload(const Texture& texture, ImageView<const std::uint8_t> image) {
  upload_as(texture, image, GL_RED, GL_UNSIGNED_BYTE);
}

void bind(int unit, const Texture& texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture.handle.get());
}

Result<Target> make_target(std::initializer_list<const Texture*> colors, const Texture* depth) {
  GLuint name = 0;
  glGenFramebuffers(1, &name);
  Target target{FramebufferHandle(name), depth ? depth->size : (*colors.begin())->size,
                static_cast<int>(colors.size()), depth != nullptr};
  glBindFramebuffer(GL_FRAMEBUFFER, name);
  std::array<GLenum, 8> buffers{};
  GLsizei count = 0;
  for (const Texture* color : colors) {
    const GLenum slot = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(count);
    glFramebufferTexture2D(GL_FRAMEBUFFER, slot, GL_TEXTURE_2D, color->handle.get(), 0);
    buffers[static_cast<std::size_t>(count++)] = slot;
  }
  if (depth)
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->handle.get(),
                           0);
  glDrawBuffers(count, buffers.data());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return target;
  return Error{ErrorCode::kUnsupported,
               fmt::format("the OpenGL ES driver cannot draw into a framebuffer of {} x {}: use "
                           "--backend cpu",
                           target.size.width, target.size.height)};
}

void drop_content(const Target& target) {
  std::array<GLenum, 9> attachments{};
  GLsizei count = 0;
  for (; count < target.colors; ++count)
    attachments[static_cast<std::size_t>(count)] =
        GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(count);
  if (target.has_depth) attachments[static_cast<std::size_t>(count++)] = GL_DEPTH_ATTACHMENT;
  glInvalidateFramebuffer(GL_FRAMEBUFFER, count, attachments.data());
}

void drop_depth(const Target& target) {
  constexpr GLenum kDepth = GL_DEPTH_ATTACHMENT;
  if (target.has_depth) glInvalidateFramebuffer(GL_FRAMEBUFFER, 1, &kDepth);
}

void bind(const Target& target) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.handle.get());
  glViewport(0, 0, target.size.width, target.size.height);
}

}  // namespace mixrig::render::gles
