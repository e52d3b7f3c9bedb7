// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/gpu_colors.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <string_view>
#include <utility>

#include <EGL/egl.h>
#include <GLES3/gl31.h>

namespace mixrig::render::gles {
namespace {

/// Type of glCopyImageSubData (OpenGL ES 3.2) and glCopyImageSubDataEXT (GL_EXT_copy_image).
using CopyImage = void (*)(GLuint, GLenum, GLint, GLint, GLint, GLint, GLuint, GLenum, GLint, GLint,
                           GLint, GLint, GLsizei, GLsizei, GLsizei);

bool is_version_3_2() {
  GLint major = 0, minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  return major > 3 || (major == 3 && minor >= 2);
}

bool has_copy_extension() {
  GLint count = 0;
  glGetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* name = glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i));
    if (std::string_view(reinterpret_cast<const char*>(name)) == "GL_EXT_copy_image") return true;
  }
  return false;
}

/// The driver's copy function; null if it has none.
CopyImage copy_image() {
  const char* const name = is_version_3_2()       ? "glCopyImageSubData"
                           : has_copy_extension() ? "glCopyImageSubDataEXT"
                                                  : nullptr;
  return name ? reinterpret_cast<CopyImage>(eglGetProcAddress(name)) : nullptr;
}

}  // namespace

/// A composite of the pool. Its bytes are sRGB in a format without conversion.
class GpuColor final : public GpuPicture {
 public:
  explicit GpuColor(Size size_px)
      : size_px_(size_px), texture_(make_texture(size_px, GL_RGBA8)), copy_image_(copy_image()) {}

  Size size_px() const override { return size_px_; }
  Result<void> copy_to_bound_texture() const override;
  void take(const Texture& color);
  /// Ends copying: the compositor goes away. Precondition: its context is current.
  void empty();

 private:
  /// A point in the queue of one context for which another context can wait. Syncs are shared
  /// objects.
  class QueuePoint {
   public:
    void set() {
      forget();
      sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
      glFlush();
    }
    /// Makes everything queued from now on in this context come after the point; returns at once.
    void wait() const {
      if (sync_ != nullptr) glWaitSync(sync_, 0, GL_TIMEOUT_IGNORED);
    }
    void forget() {
      if (sync_ != nullptr) glDeleteSync(std::exchange(sync_, nullptr));
    }

   private:
    GLsync sync_ = nullptr;
  };

  const Size size_px_;
  mutable std::mutex mutex_;  ///< guards the members below
  Texture texture_;
  CopyImage copy_image_;
  QueuePoint written_;
  mutable QueuePoint read_;
};

void GpuColor::take(const Texture& color) {
  const std::lock_guard lock(mutex_);
  read_.wait();
  copy_image_(color.handle.get(), GL_TEXTURE_2D, 0, 0, 0, 0, texture_.handle.get(), GL_TEXTURE_2D,
              0, 0, 0, 0, size_px_.width, size_px_.height, 1);
  written_.set();
}

void GpuColor::empty() {
  const std::lock_guard lock(mutex_);
  texture_ = Texture();
  written_.forget(), read_.forget();
}

Result<void> GpuColor::copy_to_bound_texture() const {
  const std::lock_guard lock(mutex_);
  if (!texture_.handle) return Error{ErrorCode::kDevice, "the composite was freed"};
  GLint bound = 0, read = 0, drawn = 0;
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read);
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &drawn);
  const bool scissors = glIsEnabled(GL_SCISSOR_TEST) == GL_TRUE;
  if (scissors) glDisable(GL_SCISSOR_TEST);
  std::array<GLuint, 2> names{};
  glGenFramebuffers(2, names.data());
  written_.wait();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, names[0]);
  glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                         texture_.handle.get(), 0);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, names[1]);
  glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                         static_cast<GLuint>(bound), 0);
  const bool whole = glCheckFramebufferStatus(GL_READ_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE &&
                     glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  if (whole)
    glBlitFramebuffer(0, 0, size_px_.width, size_px_.height, 0, 0, size_px_.width, size_px_.height,
                      GL_COLOR_BUFFER_BIT, GL_NEAREST);
  read_.set();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read));
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(drawn));
  glDeleteFramebuffers(2, names.data());
  if (scissors) glEnable(GL_SCISSOR_TEST);
  return whole ? Result<void>()
               : Error{ErrorCode::kDevice, "the driver cannot draw into the screen's texture"};
}

bool GpuColors::are_possible() { return copy_image() != nullptr; }

GpuColors::~GpuColors() {
  for (const auto& picture : pictures_) picture->empty();
}

std::shared_ptr<const GpuPicture> GpuColors::copy(const Texture& color) {
  const auto is_free = [](const auto& picture) { return picture.use_count() == 1; };
  auto found = std::find_if(pictures_.begin(), pictures_.end(), is_free);
  if (found == pictures_.end())
    found = pictures_.insert(found, std::make_shared<GpuColor>(size_px_));
  (*found)->take(color);
  return *found;
}

}  // namespace mixrig::render::gles
