// SPDX-License-Identifier: Apache-2.0
// An OpenGL ES 3.1 context without a window.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include <EGL/egl.h>

#include "hal/base/result.h"
#include "host/render/contract/compositor.h"

namespace mixrig::render::gles {

/// Owns display connection and context. On one thread at a time: release() there before another one
/// makes it current.
class EglContext {
 public:
  /// Tries EGL_MESA_platform_surfaceless, then the EGL devices, then the default display, and
  /// makes the first context that holds GLES 3.1 and float colour buffers current. Errors: kDevice
  /// where no display, or kUnsupported where no display offers that; the line names each attempt.
  static Result<EglContext> create();
  /// One whose objects are those of a screen's context as well. Errors: as create().
  static Result<EglContext> create_sharing(const GlShare& share);

  EglContext(EglContext&& other) noexcept { *this = std::move(other); }
  EglContext& operator=(EglContext&& other) noexcept;
  ~EglContext();

  /// Binds the context to this thread. Errors: kDevice.
  Result<void> make_current() const;
  /// Leaves this thread without a context, where this one is current.
  void release() const;
  /// GL_RENDERER, "llvmpipe (LLVM 15.0.6, 256 bits)".
  std::string renderer() const;
  /// Precondition: current.
  bool has_extension(std::string_view name) const;
  /// Of EGL, for its display.
  bool has_display_extension(std::string_view name) const;
  EGLDisplay display() const { return display_; }

 private:
  EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}
  static Result<EglContext> create_on(EGLDisplay display, EGLContext shared = EGL_NO_CONTEXT);

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

/// Whether the system has a GPU's device file in `dev`: without, GL is software, which need not be
/// loaded to know that (Mesa's takes 60 MB).
bool may_have_gpu(const std::filesystem::path& dev = "/dev");

/// Whether a GL_RENDERER draws on the processor, so that the cpu back end is the faster one.
bool is_software(std::string_view renderer);

}  // namespace mixrig::render::gles
