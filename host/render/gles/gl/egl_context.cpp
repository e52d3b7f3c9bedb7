// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/egl_context.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <EGL/eglext.h>
#include <GLES3/gl31.h>

namespace mixrig::render::gles {
namespace {

/// Whether a space-separated list contains a whole word.
bool contains_word(const char* list, std::string_view word) {
  const std::string_view text = list ? list : "";
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || text[at - 1] == ' ') && (end == text.size() || text[end] == ' ')) return true;
  }
  return false;
}

std::string egl_error() {
  switch (eglGetError()) {
    case EGL_SUCCESS:
      return "no display";
    case EGL_NOT_INITIALIZED:
      return "no driver";
    case EGL_BAD_ALLOC:
      return "out of memory";
    case EGL_BAD_MATCH:
      return "no such context";
    case EGL_BAD_CONFIG:
      return "no such configuration";
    default:
      return "refused";
  }
}

EGLDisplay platform_display(EGLenum platform, void* native) {
  const auto get = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  return get ? get(platform, native, nullptr) : EGL_NO_DISPLAY;
}

/// Lists the EGL devices; writes at most `devices.size()` and returns how many.
std::size_t query_devices(std::array<EGLDeviceEXT, 8>& devices) {
  const auto query =
      reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
  EGLint count = 0;
  if (!query || !query(static_cast<EGLint>(devices.size()), devices.data(), &count)) return 0;
  return static_cast<std::size_t>(
      std::clamp<EGLint>(count, 0, static_cast<EGLint>(devices.size())));
}

EGLContext create_context(EGLDisplay display, EGLContext shared, const char* extensions) {
  constexpr std::array<EGLint, 7> kConfig = {
      EGL_RENDERABLE_TYPE,   EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, 0,
      EGL_COLOR_BUFFER_TYPE, EGL_RGB_BUFFER,     EGL_NONE};
  constexpr std::array<EGLint, 5> kVersion = {EGL_CONTEXT_MAJOR_VERSION, 3,
                                              EGL_CONTEXT_MINOR_VERSION, 1, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!contains_word(extensions, "EGL_KHR_no_config_context") &&
      (!eglChooseConfig(display, kConfig.data(), &config, 1, &count) || count == 0))
    return EGL_NO_CONTEXT;
  return eglCreateContext(display, config, shared, kVersion.data());
}

}  // namespace

Result<EglContext> EglContext::create_on(EGLDisplay display, EGLContext shared) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr))
    return Error{ErrorCode::kDevice, egl_error()};
  const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
  if (!contains_word(extensions, "EGL_KHR_surfaceless_context"))
    return Error{ErrorCode::kUnsupported, "no surfaceless context"};
  eglBindAPI(EGL_OPENGL_ES_API);
  EglContext made(display, create_context(display, shared, extensions));
  if (made.context_ == EGL_NO_CONTEXT)
    return Error{ErrorCode::kUnsupported, "no OpenGL ES 3.1: " + egl_error()};
  MIXRIG_TRY(made.make_current());
  if (!made.has_extension("GL_EXT_color_buffer_float"))
    return Error{ErrorCode::kUnsupported, made.renderer() + " lacks GL_EXT_color_buffer_float"};
  return made;
}

Result<EglContext> EglContext::create() {
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  std::string tried;
  ErrorCode code = ErrorCode::kDevice;
  const auto attempt = [&](const char* name, EGLDisplay display) {
    auto result = create_on(display);
    if (!result) {
      tried += std::string(tried.empty() ? "" : "; ") + name + ": " + result.error().context;
      if (result.error().code == ErrorCode::kUnsupported) code = ErrorCode::kUnsupported;
    }
    return result;
  };
  if (contains_word(client, "EGL_MESA_platform_surfaceless"))
    if (auto made = attempt("surfaceless",
                            platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY)))
      return made;
  std::array<EGLDeviceEXT, 8> devices{};
  for (std::size_t i = 0, count = query_devices(devices); i < count; ++i)
    if (auto made = attempt("device", platform_display(EGL_PLATFORM_DEVICE_EXT, devices[i])))
      return made;
  if (auto made = attempt("default display", eglGetDisplay(EGL_DEFAULT_DISPLAY))) return made;
  return Error{code, "no OpenGL ES 3.1 context through EGL (" + tried +
                         "): install a driver (libegl1, libgl1-mesa-dri) or use --backend cpu"};
}

Result<EglContext> EglContext::create_sharing(const GlShare& share) {
  auto made = create_on(share.display, share.context);
  if (made) return made;
  return Error{made.error().code, "no OpenGL ES 3.1 context that shares with the screen's (" +
                                      made.error().context + ")"};
}

EglContext& EglContext::operator=(EglContext&& other) noexcept {
  std::swap(display_, other.display_);
  std::swap(context_, other.context_);
  return *this;
}

// All contexts of the process share the display, so it is never terminated here.
EglContext::~EglContext() {
  if (context_ == EGL_NO_CONTEXT) return;
  release();
  eglDestroyContext(display_, context_);
}

void EglContext::release() const {
  if (eglGetCurrentContext() == context_)
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

Result<void> EglContext::make_current() const {
  if (eglGetCurrentContext() == context_) return {};
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return {};
  return Error{ErrorCode::kDevice, "the OpenGL ES context cannot be bound: " + egl_error()};
}

std::string EglContext::renderer() const {
  const auto* text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return text ? text : "unknown";
}

bool EglContext::has_extension(std::string_view name) const {
  return contains_word(reinterpret_cast<const char*>(glGetString(GL_EXTENSIONS)), name);
}

bool EglContext::has_display_extension(std::string_view name) const {
  return contains_word(eglQueryString(display_, EGL_EXTENSIONS), name);
}

bool may_have_gpu(const std::filesystem::path& dev) {
  std::error_code code;
  for (auto at = std::filesystem::directory_iterator(dev / "dri", code);
       at != std::filesystem::directory_iterator(); at.increment(code))
    if (at->path().filename().string().starts_with("renderD")) return true;
  // Device files of vendors' drivers that have no node in dev/dri, or not in every container.
  constexpr std::array<std::string_view, 7> kNames = {
      "nvidiactl", "nvhost-gpu", "mali0", "kgsl-3d0", "galcore", "pvr_sync", "dxg"};
  return std::any_of(kNames.begin(), kNames.end(), [&](std::string_view name) {
    return std::filesystem::exists(dev / name, code);
  });
}

bool is_software(std::string_view renderer) {
  std::string lower(renderer);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 5> kNames = {"llvmpipe", "softpipe", "swrast",
                                                      "swiftshader", "software"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [&](std::string_view name) { return lower.find(name) != std::string::npos; });
}

}  // namespace mixrig::render::gles
