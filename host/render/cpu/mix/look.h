// SPDX-License-Identifier: Apache-2.0
// Pass look: virtual things as noisy and as sharp as the plate (picture_look.h).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/virtual/virtual.h"
#include "host/render/frame/picture_look.h"

namespace mixrig::render::cpu {

/// Adds noise to shaded colour.
struct GrainOf {
  Grain grain;
  Image<PackedNormal> noise;
  glm::ivec2 offset{0};  ///< of the frame

  bool any() const { return !noise.empty(); }
  /// Of a colour of kLinearOne, premultiplied by `coverage` > 0 of 1, at a pixel.
  glm::vec3 added(const glm::vec3& color, float coverage, int x, int y) const;
};

/// Memory of the blur.
struct BlurScratch {
  std::vector<Image<glm::vec4>> across;  ///< a thread's band of to_differences(), along rows
  VirtualLayer layer;                    ///< what is filtered: rect, coverage, w and color
};

/// Filters colour and coverage of `from` into scratch.layer. Pixels that only the blur covers are
/// as near as the nearest pixel that they are blurred from. Allocates in the first frame only.
void blur_layer(Crew& crew, const LookFilter& filter, const VirtualLayer& from,
                BlurScratch& scratch);

}  // namespace mixrig::render::cpu
