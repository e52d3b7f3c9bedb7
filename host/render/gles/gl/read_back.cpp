// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/read_back.h"

#include <algorithm>
#include <cassert>

namespace mixrig::render::gles {
namespace {

/// Maps the bound pixel pack buffer for reading until the end of the block.
class Mapping {
 public:
  Mapping(const BufferHandle& buffer, std::size_t bytes) {
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer.get());
    data_ =
        glMapBufferRange(GL_PIXEL_PACK_BUFFER, 0, static_cast<GLsizeiptr>(bytes), GL_MAP_READ_BIT);
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping() {
    if (data_) glUnmapBuffer(GL_PIXEL_PACK_BUFFER);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  }
  const void* data() const { return data_; }

 private:
  const void* data_ = nullptr;
};

Error not_mapped() {
  return {ErrorCode::kDevice,
          "the OpenGL ES driver does not give a picture back: use --backend cpu"};
}

/// GL_RED if the driver reads it from the current attachment, else GL_RGBA, which every driver
/// offers.
GLenum first_channel_format(GLenum type) {
  GLint own_format = 0, own_type = 0;
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_FORMAT, &own_format);
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_TYPE, &own_type);
  return own_format == GL_RED && own_type == static_cast<GLint>(type) ? GL_RED : GL_RGBA;
}

}  // namespace

void ReadBack::start(const Target& target, int index, GLenum type, bool all_channels) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target.handle.get());
  glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(index));
  if (!buffer_) {
    GLuint name = 0;
    glGenBuffers(1, &name);
    buffer_ = BufferHandle(name);
    format_ = all_channels ? GL_RGBA : first_channel_format(type);
  }
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.get());
  if (size_ != target.size) {
    size_ = target.size;
    bytes_ = size_.area() * (format_ == GL_RED ? 1 : 4) * (type == GL_FLOAT ? sizeof(float) : 1);
    glBufferData(GL_PIXEL_PACK_BUFFER, static_cast<GLsizeiptr>(bytes_), nullptr, GL_STREAM_READ);
  }
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size_.width, size_.height, format_, type, nullptr);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

template <typename T>
Result<void> ReadBack::fetch_first(ImageView<T> out) const {
  assert(out.size == size_);
  const Mapping mapping(buffer_, bytes_);
  const T* from = static_cast<const T*>(mapping.data());
  if (!from) return not_mapped();
  const std::ptrdiff_t width = size_.width;
  for (int y = 0; y < size_.height; ++y) {
    if (format_ == GL_RED)
      std::copy_n(from + y * width, width, out.row(y));
    else
      for (std::ptrdiff_t x = 0; x < width; ++x) out.row(y)[x] = from[4 * (y * width + x)];
  }
  return {};
}
template Result<void> ReadBack::fetch_first(ImageView<float> out) const;
template Result<void> ReadBack::fetch_first(ImageView<std::uint8_t> out) const;

Result<void> ReadBack::fetch(ImageView<Rgb8> color, ImageView<std::uint8_t> alpha) const {
  assert((color.empty() || color.size == size_) && (alpha.empty() || alpha.size == size_));
  const Mapping mapping(buffer_, bytes_);
  const auto* rgba = static_cast<const std::uint8_t*>(mapping.data());
  if (!rgba) return not_mapped();
  for (int y = 0; y < size_.height; ++y, rgba += 4 * size_.width) {
    for (int x = 0; x < color.size.width; ++x)
      color.row(y)[x] = {rgba[4 * x], rgba[4 * x + 1], rgba[4 * x + 2]};
    for (int x = 0; x < alpha.size.width; ++x) alpha.row(y)[x] = rgba[4 * x + 3];
  }
  return {};
}

void Fence::set() {
  sync_.reset(glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0));
  glFlush();
}

Result<void> Fence::wait() const {
  constexpr GLuint64 kMostNs = 10'000'000'000;
  switch (glClientWaitSync(sync_.get(), GL_SYNC_FLUSH_COMMANDS_BIT, kMostNs)) {
    case GL_ALREADY_SIGNALED:
    case GL_CONDITION_SATISFIED:
      return {};
    case GL_TIMEOUT_EXPIRED:
      return Error{ErrorCode::kTimeout,
                   "the GPU did not finish a frame within 10 s: use --backend cpu"};
    default:
      return Error{ErrorCode::kDevice,
                   "the OpenGL ES driver lost a frame: restart, or use --backend cpu"};
  }
}

}  // namespace mixrig::render::gles
