// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/upload_ring.h"

#include <cassert>
#include <utility>

namespace mixrig::render::gles {
namespace {

void write_row(const Rgb8* from, int count, Rgbx8* to) {
  for (int x = 0; x < count; ++x) to[x] = {from[x].r, from[x].g, from[x].b, 255};
}

}  // namespace

Result<void> UploadRing::upload(const Texture& texture, ImageView<const Rgb8> picture) {
  assert(picture.size == texture.size);
  const auto bytes = static_cast<GLsizeiptr>(picture.size.area() * sizeof(Rgbx8));
  if (std::exchange(size_, picture.size) != picture.size) buffers_ = {};
  BufferHandle& buffer = buffers_[std::exchange(next_, (next_ + 1) % buffers_.size())];
  if (!buffer) {
    GLuint name = 0;
    glGenBuffers(1, &name);
    buffer = BufferHandle(name);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, name);
    glBufferData(GL_PIXEL_UNPACK_BUFFER, bytes, nullptr, GL_STREAM_DRAW);
  }
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer.get());
  auto* to = static_cast<Rgbx8*>(glMapBufferRange(GL_PIXEL_UNPACK_BUFFER, 0, bytes,
                                                  GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT));
  for (int y = 0; to != nullptr && y < picture.size.height; ++y, to += picture.size.width)
    write_row(picture.row(y), picture.size.width, to);
  const bool written = to != nullptr && glUnmapBuffer(GL_PIXEL_UNPACK_BUFFER);
  if (written) {
    glBindTexture(GL_TEXTURE_2D, texture.handle.get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, picture.size.width, picture.size.height, GL_RGBA,
                    GL_UNSIGNED_BYTE, nullptr);
  }
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  if (written) return {};
  return Error{ErrorCode::kDevice,
               "the OpenGL ES driver does not take a picture: use --backend cpu"};
}

}  // namespace mixrig::render::gles
