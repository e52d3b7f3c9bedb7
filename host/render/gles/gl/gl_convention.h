// SPDX-License-Identifier: Apache-2.0
// Conversion between pixel and OpenGL coordinates, in this file only. Ours: pixel (0,0) is the
// centre of the top-left pixel, y down. OpenGL's: (0,0) is a corner, and y grows from the first row
// in memory. Our first row in memory is the top one, so picture row v is framebuffer row v and
// texture row v: nothing is flipped, but half a pixel is added, and triangles keep their
// orientation.
#pragma once

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/contract/passes.h"

namespace mixrig::render::gles {
inline constexpr auto kNearM = static_cast<float>(kNearestM);  ///< nearer surfaces are clipped

/// Matrix from homogeneous camera points (x, y, z, w) to clip space. Point (x, y, z) / w lands on
/// its pixel of `camera` in a framebuffer of `size`, and window depth is near / z: 1 at the near
/// plane, 0 infinitely far. GL_GREATER and a depth cleared to 0 keep the nearest surface.
inline glm::mat4 clip_from_camera(const PinholeParams& camera, Size size) {
  const glm::vec2 scale = 2.0F / glm::vec2(size.width, size.height);
  glm::mat4 m(0);
  m[0].x = scale.x * camera.focal_px.x;
  m[1].y = scale.y * camera.focal_px.y;
  m[2].x = scale.x * (camera.center_px.x + 0.5F) - 1;
  m[2].y = scale.y * (camera.center_px.y + 0.5F) - 1;
  m[2].z = -1;
  m[2].w = 1;
  m[3].z = 2 * kNearM;
  return m;
}

/// z of a window depth made by clip_from_camera; infinity where nothing was drawn.
inline float z_from_window_depth(float depth) { return kNearM / depth; }

/// Pinhole of the part of a picture that starts at `origin_px`, with `factor` samples a pixel along
/// each axis, evenly spread: (+-0.25, +-0.25) for two.
inline PinholeParams window_of(const PinholeParams& camera, glm::vec2 origin_px, float factor) {
  return {camera.focal_px * factor, (camera.center_px - origin_px + 0.5F) * factor - 0.5F};
}

}  // namespace mixrig::render::gles
