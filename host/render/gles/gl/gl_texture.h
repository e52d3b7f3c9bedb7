// SPDX-License-Identifier: Apache-2.0
// Textures and render targets. Row 0 of an image is row 0 of its texture and framebuffer
// (gl_convention.h), so nothing is flipped.
#pragma once

#include <initializer_list>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/render/gles/gl/gl_handles.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::gles {

struct Texture {
  TextureHandle handle;
  Size size;
  GLenum internal_format = 0;
};

enum class Sampling { kNearest, kLinear, kRepeat };

/// Makes a texture with immutable storage, clamped to the edge; kRepeat samples linearly and
/// repeats. Its content is undefined.
Texture make_texture(Size size, GLenum internal_format, Sampling sampling = Sampling::kNearest);

/// Makes and binds a texture without storage, which the next call must give it. Nearest sampling,
/// clamped to the edge.
Texture make_unsized_texture(Size size, GLenum internal_format);

/// Copies an image, of any stride, into a texture of the same size.
void upload(const Texture& texture, ImageView<const float> image);      // GL_R32F
void upload(const Texture& texture, ImageView<const glm::vec2> image);  // GL_RG32F
void upload(const Texture& texture, ImageView<const Rgb8> image);       // GL_SRGB8, GL_RGB8
void upload(const Texture& texture, ImageView<const Rgbx8> image);      // GL_SRGB8_ALPHA8, GL_RGBA8
void upload(const Texture& texture, ImageView<const Rgbf> image);       // GL_RGB16F, GL_RGB32F
void upload(const Texture& texture, ImageView<const PackedNormal> image);  // GL_RGBA8_SNORM
void upload(const Texture& texture, ImageView<const std::uint8_t> image);  // GL_R8

/// Makes a texture that holds an image; T may be const.
template <typename T>
Texture make_texture(ImageView<T> image, GLenum internal_format,
                     Sampling sampling = Sampling::kNearest) {
  Texture texture = make_texture(image.size, internal_format, sampling);
  upload(texture, ImageView<const T>{image.data, image.size, image.stride});
  return texture;
}

/// Binds a texture for sampling on a unit.
void bind(int unit, const Texture& texture);

/// A framebuffer with colour attachments in order, and optionally a depth texture.
struct Target {
  FramebufferHandle handle;
  Size size;
  int colors = 0;  ///< number of colour attachments
  bool has_depth = false;
};
/// Makes a target. Errors: kUnsupported where the driver cannot draw into these formats.
Result<Target> make_target(std::initializer_list<const Texture*> colors,
                           const Texture* depth = nullptr);
/// Directs all later draws to the whole of this target.
void bind(const Target& target);
/// Tells the driver that nothing reads what the bound target holds, so that a GPU that draws in
/// tiles does not load it. Precondition: every later draw or clear before a read covers all of it.
void drop_content(const Target& target);
/// Drops the depth of the bound target, after its last draw: tiles are then not stored.
void drop_depth(const Target& target);

}  // namespace mixrig::render::gles
