// SPDX-License-Identifier: Apache-2.0
// Creates and owns an OpenGL ES 3.1 context without a window.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include <EGL/egl.h>

#include "hal/base/result.h"
#include "host/render/contract/compositor.h"

namespace mixrig::render::gles {

/// Owns display connection and context. May be current in one thread at a time: call release()
/// there before another thread makes it current.
class EglContext {
 public:
  /// Tries EGL_MESA_platform_surfaceless, then the EGL devices, then the default display, and makes
  /// the first context with GLES 3.1 and float colour buffers current. Errors: kDevice if there is
  /// no display, kUnsupported if none offers that; the message names each attempt.
  static Result<EglContext> create();
  /// Creates a context that shares its objects with a screen's context. Errors: those of create().
  static Result<EglContext> create_sharing(const GlShare& share);

  EglContext(EglContext&& other) noexcept { *this = std::move(other); }
  EglContext& operator=(EglContext&& other) noexcept;
  ~EglContext();

  /// Binds the context to this thread. Errors: kDevice.
  Result<void> make_current() const;
  /// If this context is current in the calling thread, leaves the thread without a context.
  void release() const;
  /// Returns GL_RENDERER, such as "llvmpipe (LLVM 15.0.6, 256 bits)".
  std::string renderer() const;
  /// Whether GL has the extension. Precondition: the context is current.
  bool has_extension(std::string_view name) const;
  /// Whether EGL has the extension for this display.
  bool has_display_extension(std::string_view name) const;
  EGLDisplay display() const { return display_; }

 private:
  EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}
  static Result<EglContext> create_on(EGLDisplay display, EGLContext shared = EGL_NO_CONTEXT);

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

/// Whether `dev` holds a GPU's device file. Without one GL can only be software, and need not be
/// loaded to find out (Mesa's takes 60 MB).
bool may_have_gpu(const std::filesystem::path& dev = "/dev");

/// Whether a GL_RENDERER is a software renderer, so that the cpu back end is faster.
bool is_software(std::string_view renderer);

}  // namespace mixrig::render::gles
