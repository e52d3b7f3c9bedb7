// SPDX-License-Identifier: Apache-2.0
// Makes textures of camera pictures in the camera's own memory (EGL_EXT_image_dma_buf_import).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES2/gl2.h>  // what gl2ext.h needs before it
#include <GLES2/gl2ext.h>

#include "hal/base/raw_picture.h"
#include "host/render/gles/gl/egl_context.h"
#include "host/render/gles/gl/gl_texture.h"

namespace mixrig::render::gles {

/// One plane of plain samples, which the driver does not convert.
struct PlaneLayout {
  std::uint32_t fourcc = 0;  ///< DRM format: R8 or GR88
  GLenum internal_format = 0;
  Size size{};  ///< texels
  std::size_t offset_bytes = 0, stride_bytes = 0;
};
struct PlaneLayouts {
  std::array<PlaneLayout, 2> planes;
  std::size_t count = 1;
};
/// Planes of a picture in its memory, as decode.frag reads them.
PlaneLayouts planes_of(const RawPicture& picture);

/// EGL and GL functions that imports need.
struct ImportCalls {
  EGLDisplay display = EGL_NO_DISPLAY;
  PFNEGLCREATEIMAGEKHRPROC create = nullptr;
  PFNEGLDESTROYIMAGEKHRPROC destroy = nullptr;
  PFNGLEGLIMAGETARGETTEXTURE2DOESPROC attach = nullptr;
  bool modifiers = false;  ///< EGL takes modifiers, which tell it that rows follow one another
};
/// Finds the functions. Precondition: the context is current. Errors: kUnsupported; the message
/// names what is missing.
Result<ImportCalls> find_import_calls(const EglContext& context);

/// Textures of the planes of one picture.
using ImportedPlanes = std::array<Texture, 2>;

/// Imports each buffer of a camera once; all are dropped when a picture of another set of buffers
/// comes. Only for the thread of the context.
class PlateImports {
 public:
  explicit PlateImports(const ImportCalls& calls);

  /// Textures of a picture in shared memory, valid until the next call. Null once the driver has
  /// refused a picture: why() then gives the reason, and no more are tried.
  const ImportedPlanes* find(const RawPicture& picture);
  /// Reason of the refusal; empty while nothing was refused.
  const std::string& why() const { return why_; }
  /// Number of buffers imported at present.
  std::size_t size() const { return imported_.size(); }

 private:
  struct Imported {
    std::uint32_t index = 0;
    RawLayout layout{};
    std::size_t offset_bytes = 0, stride_bytes = 0;
    Size size{};
    ImportedPlanes planes;
    bool is_of(const RawPicture& picture) const;
  };
  bool import(const RawPicture& picture, const PlaneLayout& layout, Texture& texture);
  EGLImageKHR create(const DmaBuf& memory, const PlaneLayout& layout, bool linear) const;

  ImportCalls calls_;
  std::uint64_t set_ = 0;
  std::vector<Imported> imported_;
  std::string why_;
};

}  // namespace mixrig::render::gles
