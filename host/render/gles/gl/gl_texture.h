// SPDX-License-Identifier: Apache-2.0
// Textures and targets. Row 0 of an image is row 0 of a texture
// and of a framebuffer (gl_convention.h), so nothing is ever flipped.
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

/// Immutable storage, clamped to the edge; kRepeat is linear and repeats. Content undefined.
Texture make_texture(Size size, GLenum internal_format, Sampling sampling = Sampling::kNearest);

/// A name without storage, bound: the next call gives it some. Nearest, clamped to the edge.
Texture make_unsized_texture(Size size, GLenum internal_format);

/// Rows of any stride into all of a texture of the same size.
void upload(const Texture& texture, ImageView<const float> image);         // GL_R32F
void upload(const Texture& texture, ImageView<const glm::vec2> image);     // GL_RG32F
void upload(const Texture& texture, ImageView<const Rgb8> image);          // GL_SRGB8, GL_RGB8
void upload(const Texture& texture, ImageView<const Rgbx8> image);  // GL_SRGB8_ALPHA8, GL_RGBA8
void upload(const Texture& texture, ImageView<const Rgbf> image);          // GL_RGB16F, GL_RGB32F
void upload(const Texture& texture, ImageView<const PackedNormal> image);  // GL_RGBA8_SNORM
void upload(const Texture& texture, ImageView<const std::uint8_t> image);  // GL_R8

/// A texture that holds an image; T may be const.
template <typename T>
Texture make_texture(ImageView<T> image, GLenum internal_format,
                     Sampling sampling = Sampling::kNearest) {
  Texture texture = make_texture(image.size, internal_format, sampling);
  upload(texture, ImageView<const T>{image.data, image.size, image.stride});
  return texture;
}

/// Binds for sampling.
void bind(int unit, const Texture& texture);

/// Colour attachments in order, and a depth texture or none.
struct Target {
  FramebufferHandle handle;
  Size size;
};
/// Errors: kUnsupported where the driver cannot draw into these formats.
Result<Target> make_target(std::initializer_list<const Texture*> colors,
                           const Texture* depth = nullptr);
/// Draws go to all of this target from now on.
void bind(const Target& target);

}  // namespace mixrig::render::gles
