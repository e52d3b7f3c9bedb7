// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl_texture.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <string>

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

void read_from(const Target& target, int index) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target.handle.get());
  glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(index));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
}

template <typename T>
void read_first_channel(const Target& target, int index, ImageView<T> out, GLenum type,
                        Scratch& scratch) {
  assert(out.size == target.size);
  read_from(target, index);
  GLint own_format = 0, own_type = 0;
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_FORMAT, &own_format);
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_TYPE, &own_type);
  if (own_format == GL_RED && own_type == static_cast<GLint>(type)) {
    glPixelStorei(GL_PACK_ROW_LENGTH, static_cast<GLint>(out.stride));
    glReadPixels(0, 0, out.size.width, out.size.height, GL_RED, type, out.data);
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
    return;
  }
  // RGBA is what every driver gives.
  scratch.resize(sizeof(T) * out.size.area());
  glReadPixels(0, 0, out.size.width, out.size.height, GL_RGBA, type, scratch.data());
  const T* from = reinterpret_cast<const T*>(scratch.data());
  for (int y = 0; y < out.size.height; ++y)
    for (int x = 0; x < out.size.width; ++x, from += 4) out.row(y)[x] = *from;
}

}  // namespace

Texture make_texture(Size size, GLenum internal_format, Sampling sampling) {
  GLuint name = 0;
  glGenTextures(1, &name);
  Texture texture{TextureHandle(name), size, internal_format};
  glBindTexture(GL_TEXTURE_2D, name);
  glTexStorage2D(GL_TEXTURE_2D, 1, internal_format, size.width, size.height);
  const GLint filter = sampling == Sampling::kNearest ? GL_NEAREST : GL_LINEAR;
  const GLint wrap = sampling == Sampling::kRepeat ? GL_REPEAT : GL_CLAMP_TO_EDGE;
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
  return texture;
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
  Target target{FramebufferHandle(name), depth ? depth->size : (*colors.begin())->size};
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
  return Error{ErrorCode::kUnsupported, "the OpenGL ES driver cannot draw into a framebuffer of " +
                                            std::to_string(target.size.width) + " x " +
                                            std::to_string(target.size.height) +
                                            ": use --backend cpu"};
}

void bind(const Target& target) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.handle.get());
  glViewport(0, 0, target.size.width, target.size.height);
}

void read_back(const Target& target, int index, ImageView<float> out, Scratch& scratch) {
  read_first_channel(target, index, out, GL_FLOAT, scratch);
}
void read_back(const Target& target, int index, ImageView<std::uint8_t> out, Scratch& scratch) {
  read_first_channel(target, index, out, GL_UNSIGNED_BYTE, scratch);
}

void read_back_rgba(const Target& target, int index, Scratch& out) {
  read_from(target, index);
  out.resize(target.size.area());
  glReadPixels(0, 0, target.size.width, target.size.height, GL_RGBA, GL_UNSIGNED_BYTE, out.data());
}

}  // namespace mixrig::render::gles
