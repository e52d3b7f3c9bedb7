// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/plate/plate_import.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace mixrig::render::gles {
namespace {

// A V4L2 driver has at most 32 buffers.
constexpr std::size_t kMostImports = 32;

constexpr std::uint32_t drm_fourcc(char a, char b, char c, char d) {
  return static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b) << 8 |
         static_cast<std::uint32_t>(c) << 16 | static_cast<std::uint32_t>(d) << 24;
}
// Formats of the kernel's drm_fourcc.h: one byte a texel; two bytes, red first, then green.
constexpr std::uint32_t kDrmR8 = drm_fourcc('R', '8', ' ', ' ');
constexpr std::uint32_t kDrmGr88 = drm_fourcc('G', 'R', '8', '8');

Error lacks(const char* what) {
  return {ErrorCode::kUnsupported, std::string("the driver offers no ") + what};
}

template <typename Call>
bool find_call(const char* name, Call& call) {
  call = reinterpret_cast<Call>(eglGetProcAddress(name));
  return call != nullptr;
}

}  // namespace

PlaneLayouts planes_of(const RawPicture& picture) {
  const Size size = picture.size;
  const std::size_t offset = picture.memory.offset_bytes, stride = picture.stride_bytes;
  if (picture.layout == RawLayout::kYuyv)
    return {{{{kDrmGr88, GL_RG8, {size.width + size.width % 2, size.height}, offset, stride}, {}}},
            1};
  const PlaneLayout samples{kDrmR8, GL_R8, size, offset, stride};
  if (picture.layout != RawLayout::kNv12) return {{{samples, {}}}, 1};
  const std::size_t luma_bytes = stride * static_cast<std::size_t>(size.height);
  return {{{samples,
            {kDrmGr88,
             GL_RG8,
             {(size.width + 1) / 2, (size.height + 1) / 2},
             offset + luma_bytes,
             stride}}},
          2};
}

Result<ImportCalls> find_import_calls(const EglContext& context) {
  ImportCalls calls{.display = context.display()};
  if (!context.has_display_extension("EGL_EXT_image_dma_buf_import"))
    return lacks("EGL_EXT_image_dma_buf_import");
  if (!context.has_extension("GL_OES_EGL_image")) return lacks("GL_OES_EGL_image");
  if (!find_call("eglCreateImageKHR", calls.create) ||
      !find_call("eglDestroyImageKHR", calls.destroy))
    return lacks("EGL_KHR_image_base");
  if (!find_call("glEGLImageTargetTexture2DOES", calls.attach)) return lacks("GL_OES_EGL_image");
  calls.modifiers = context.has_display_extension("EGL_EXT_image_dma_buf_import_modifiers");
  return calls;
}

PlateImports::PlateImports(const ImportCalls& calls) : calls_(calls) {
  imported_.reserve(kMostImports);
}

bool PlateImports::Imported::is_of(const RawPicture& picture) const {
  return index == picture.memory.index && offset_bytes == picture.memory.offset_bytes &&
         layout == picture.layout && size == picture.size && stride_bytes == picture.stride_bytes;
}

const ImportedPlanes* PlateImports::find(const RawPicture& picture) {
  if (!why_.empty()) return nullptr;
  if (std::exchange(set_, picture.memory.set) != picture.memory.set ||
      imported_.size() == kMostImports)
    imported_.clear();
  const auto known = std::find_if(imported_.begin(), imported_.end(),
                                  [&](const Imported& i) { return i.is_of(picture); });
  if (known != imported_.end()) return &known->planes;
  Imported made{picture.memory.index, picture.layout, picture.memory.offset_bytes,
                picture.stride_bytes, picture.size,   {}};
  const PlaneLayouts layouts = planes_of(picture);
  for (std::size_t i = 0; i < layouts.count; ++i)
    if (!import(picture, layouts.planes[i], made.planes[i])) {
      imported_.clear();
      return nullptr;
    }
  return &imported_.emplace_back(std::move(made)).planes;
}

EGLImageKHR PlateImports::create(const DmaBuf& memory, const PlaneLayout& layout,
                                 bool linear) const {
  const auto number = [](auto value) { return static_cast<EGLint>(value); };
  // EGL reads the list up to the first EGL_NONE.
  const std::array<EGLint, 17> attributes = {EGL_WIDTH,
                                             layout.size.width,
                                             EGL_HEIGHT,
                                             layout.size.height,
                                             EGL_LINUX_DRM_FOURCC_EXT,
                                             number(layout.fourcc),
                                             EGL_DMA_BUF_PLANE0_FD_EXT,
                                             memory.fd,
                                             EGL_DMA_BUF_PLANE0_OFFSET_EXT,
                                             number(layout.offset_bytes),
                                             EGL_DMA_BUF_PLANE0_PITCH_EXT,
                                             number(layout.stride_bytes),
                                             linear ? EGL_DMA_BUF_PLANE0_MODIFIER_LO_EXT : EGL_NONE,
                                             0,
                                             EGL_DMA_BUF_PLANE0_MODIFIER_HI_EXT,
                                             0,
                                             EGL_NONE};
  return calls_.create(calls_.display, EGL_NO_CONTEXT, EGL_LINUX_DMA_BUF_EXT, nullptr,
                       attributes.data());
}

/// Imports one plane. The texture keeps the memory, so the EGL image is destroyed again.
bool PlateImports::import(const RawPicture& picture, const PlaneLayout& layout, Texture& texture) {
  EGLImageKHR image = calls_.modifiers ? create(picture.memory, layout, true) : EGL_NO_IMAGE_KHR;
  if (image == EGL_NO_IMAGE_KHR) image = create(picture.memory, layout, false);
  if (image == EGL_NO_IMAGE_KHR) {
    why_ = fmt::format("the driver does not take a camera's buffer of {}x{} (EGL error 0x{:x})",
                       picture.size.width, picture.size.height, eglGetError());
    return false;
  }
  texture = make_unsized_texture(layout.size, layout.internal_format);
  calls_.attach(GL_TEXTURE_2D, image);
  const GLenum error = glGetError();
  calls_.destroy(calls_.display, image);
  if (error == GL_NO_ERROR) return true;
  why_ = fmt::format("the driver makes no texture of a camera's buffer (GL error 0x{:x})", error);
  return false;
}

}  // namespace mixrig::render::gles
