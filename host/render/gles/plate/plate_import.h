// SPDX-License-Identifier: Apache-2.0
// Camera pictures as textures, read in the camera's own memory (EGL_EXT_image_dma_buf_import).
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

/// Plain samples: the driver converts nothing.
struct PlaneLayout {
  std::uint32_t fourcc = 0;  ///< DRM's: R8 or GR88
  GLenum internal_format = 0;
  Size size{};  ///< texels
  std::size_t offset_bytes = 0, stride_bytes = 0;
};
struct PlaneLayouts {
  std::array<PlaneLayout, 2> planes;
  std::size_t count = 1;
};
/// Of a picture in its memory; what decode.frag reads.
PlaneLayouts planes_of(const RawPicture& picture);

/// What imports need of EGL and GL.
struct ImportCalls {
  EGLDisplay display = EGL_NO_DISPLAY;
  PFNEGLCREATEIMAGEKHRPROC create = nullptr;
  PFNEGLDESTROYIMAGEKHRPROC destroy = nullptr;
  PFNGLEGLIMAGETARGETTEXTURE2DOESPROC attach = nullptr;
  bool modifiers = false;  ///< it is told that rows follow one another
};
/// Precondition: the context is current. Errors: kUnsupported; the line names what lacks.
Result<ImportCalls> find_import_calls(const EglContext& context);

/// The planes of one picture.
using ImportedPlanes = std::array<Texture, 2>;

/// Each buffer of a camera is imported once; those of a set are dropped when a picture of another
/// one comes. For the thread of the context.
class PlateImports {
 public:
  explicit PlateImports(const ImportCalls& calls);

  /// The textures of a picture whose memory is shared, valid until the next call; null where the
  /// driver has refused one: then why() says so, and no further is tried.
  const ImportedPlanes* find(const RawPicture& picture);
  /// Empty while nothing was refused.
  const std::string& why() const { return why_; }
  /// That exist now.
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
